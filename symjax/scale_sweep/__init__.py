"""Fits of one set of pairs for many scales σ and starts: optima, summary, export, and an interactive page."""
