"""Names of solvers and of starts, for those who offer a choice before JAX is imported."""

SOLVERS = ("newton", "mm", "joint", "alternating")
"""Keys of `symjax.l2e.solvers.registry.SOLVERS`."""

STARTS = ("fibonacci", "hypotheses", "random", "rga", "pca", "l2")
"""Starts of `symjax.sweep`; the last three are one start each."""
