"""Errors and warnings on one line each."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import click

from symjax.errors import SymjaxError, SymjaxWarning


@contextmanager
def one_line_errors(debug: bool) -> Iterator[None]:
    """Our errors become one line (a traceback with `debug`), our warnings one line each."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", SymjaxWarning)
        try:
            yield
        except SymjaxError as error:
            if debug:
                raise
            raise click.ClickException(str(error)) from error
        finally:
            # not while the work goes on: the line of progress would run into them
            for warning in caught:
                click.echo(f"symjax: warning: {' '.join(str(warning.message).split())}", err=True)
