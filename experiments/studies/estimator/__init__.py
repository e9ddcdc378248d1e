"""Studies of the L2E estimator alone, on planted pairs: accuracy, derivatives and robustness."""
