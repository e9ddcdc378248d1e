"""The names of starts. No JAX is needed to read them."""

STARTS = ("fibonacci", "hypotheses", "random", "rga", "pca", "l2")
"""Starts of `symjax.sweep`; the last three are one start each."""
