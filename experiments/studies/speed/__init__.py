"""experiments/studies/speed."""
