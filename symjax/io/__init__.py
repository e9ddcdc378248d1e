"""Clouds, meshes and pairs read from files, strictly, and files written so that no reader meets half of one."""
