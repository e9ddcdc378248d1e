"""Strict readers of clouds, meshes and pairs, and writers that never leave an incomplete file."""
