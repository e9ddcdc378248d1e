"""Seconds and memory: of the objective, of fits, of sweeps and of whole detections."""
