"""Pictures of a detection: an interactive page and a PNG."""
