"""The figures and tables of the paper, and the numbers of the README: `python -m experiments.run list`."""
