"""The figures and tables of the paper, and the numbers of the README, run for real: see README.md here."""
