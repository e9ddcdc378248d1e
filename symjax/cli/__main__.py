"""`python -m symjax.cli`."""

from symjax.cli.main import main

main()
