"""Comparison of all methods on the same corrupted clouds: objects, tasks, leaderboard, curves and published numbers."""
