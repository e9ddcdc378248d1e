"""experiments/studies/robust."""
