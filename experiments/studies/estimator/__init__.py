"""The L2E estimator alone, on planted pairs: its numbers, its derivatives, and what it withstands."""
