"""Studies of run time and memory: of the objective, fits, sweeps and whole detections."""
