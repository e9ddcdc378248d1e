"""Studies that produce the figures, tables and numbers of the README: `python -m experiments.run list`."""
