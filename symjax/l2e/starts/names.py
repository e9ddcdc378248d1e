"""The names of the starts. This module does not import JAX."""

STARTS = ("fibonacci", "hypotheses", "random", "rga", "pca", "l2")
"""Starts of `symjax.sweep`. The last three are a single start each."""
