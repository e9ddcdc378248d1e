"""`python -m symjax.cli`."""

from symjax.cli import main

main()
