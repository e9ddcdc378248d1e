"""Planes, directions, similarities and uncertainties, for NumPy and JAX arrays."""
