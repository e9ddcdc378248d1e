"""The solvers of the estimator: one interface, one loop, one plane or thousands of them at a time."""
