"""Options that several commands have."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

Command = Callable[..., None]


def output(name: str, placeholder: str, text: str) -> Callable[[Command], Command]:
    """An option that names a file to write."""
    return click.option(name, type=click.Path(path_type=Path), metavar=placeholder, help=text)


def seed(default: int, text: str) -> Callable[[Command], Command]:
    """The seed."""
    return click.option("--seed", type=click.IntRange(min=0), metavar="N", default=default, help=text)


def _all(*options: Callable[[Any], Any]) -> Callable[[Command], Command]:
    """Several options as one, listed in this order."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


reading = _all(
    click.option("--samples", type=int, metavar="N", default=20_000, help="Points to sample from a mesh."),
    click.option("--nonfinite", type=click.Choice(["raise", "drop"]), default="raise", help="NaN and infinite points."),
)
"""Options of the commands that read a file."""

computing = _all(
    click.option("--cache", is_flag=True, help="Keep compiled programs in the user's cache folder: starts faster."),
    click.option("--quiet", is_flag=True, help="No progress on stderr."),
    click.option("--debug", is_flag=True, help="Show the traceback of an error."),
)
"""Options that every command that computes has."""

as_json = click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")

force = click.option("--force", is_flag=True, help="Replace files that exist.")
