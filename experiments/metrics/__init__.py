"""Metrics of detected planes, one per file, as defined by their publications."""
