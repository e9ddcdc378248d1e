"""Runs the command line by `python -m symjax.cli`."""

from symjax.cli.main import main

main()
