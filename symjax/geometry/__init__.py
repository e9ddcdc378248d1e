"""Planes, directions, similarities and uncertainties: geometry that every other package uses, on NumPy and JAX arrays."""
