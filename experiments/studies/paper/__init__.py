"""experiments/studies/paper."""
