"""Options shared by several commands."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

Command = Callable[..., None]


def output(name: str, placeholder: str, text: str) -> Callable[[Command], Command]:
    """Returns an option for the path of an output file."""
    return click.option(name, type=click.Path(path_type=Path), metavar=placeholder, help=text)


def seed(default: int, text: str) -> Callable[[Command], Command]:
    """Returns the option for the seed."""
    return click.option("--seed", type=click.IntRange(min=0), metavar="N", default=default, help=text)


def _all(*options: Callable[[Any], Any]) -> Callable[[Command], Command]:
    """Combines options into one decorator; the help lists them in this order."""

    def add(command: Command) -> Command:
        for option in reversed(options):
            command = option(command)
        return command

    return add


reading = _all(
    click.option("--samples", type=int, metavar="N", default=20_000, help="Points sampled from a mesh."),
    click.option(
        "--nonfinite",
        type=click.Choice(["raise", "drop"]),
        default="raise",
        help="Treatment of points that are NaN or infinite: raise an error, or drop them.",
    ),
)
"""Options of commands that read a file."""

computing = _all(
    click.option("--cache", is_flag=True, help="Cache compiled programs, so that later runs start faster."),
    click.option("--quiet", is_flag=True, help="Do not show progress."),
    click.option("--debug", is_flag=True, help="Show the traceback of an error."),
)
"""Options of all commands."""

as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as one JSON object.")

force = click.option("--force", is_flag=True, help="Overwrite existing files.")
