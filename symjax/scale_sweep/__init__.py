"""The scale sweep: fits of one set of pairs for many scales σ and starts, their optima, and an interactive page."""
