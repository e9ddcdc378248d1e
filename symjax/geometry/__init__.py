"""Planes, directions, similarities and uncertainties, on NumPy and JAX arrays alike."""
