"""Errors and warnings, each printed as one line."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import click

from symjax.errors import SymjaxError, SymjaxWarning


@contextmanager
def one_line_errors(debug: bool) -> Iterator[None]:
    """Prints symjax's warnings as one line each, and turns its errors into one line, or a traceback with `debug`."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", SymjaxWarning)
        try:
            yield
        except SymjaxError as error:
            if debug:
                raise
            raise click.ClickException(str(error)) from error
        finally:
            # only at the end, since warnings would break the progress line
            for warning in caught:
                click.echo(f"symjax: warning: {' '.join(str(warning.message).split())}", err=True)
