"""experiments/studies/estimator."""
