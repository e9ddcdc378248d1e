"""experiments/studies/symhks."""
