"""Studies that reproduce the figures and tables of the paper."""
