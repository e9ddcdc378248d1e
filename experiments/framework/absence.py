"""Data of other people that is not here: said loudly, and what to do about it."""

from pathlib import Path

from symjax.errors import SymjaxError


class DataAbsentError(SymjaxError):
    """The files of a published benchmark are not where they were looked for."""


def required(path: Path, instructions: str) -> Path:
    """The path.

    Args:
        path: a file or a folder.
        instructions: where to get the data, and how to lay it out.

    Raises:
        DataAbsentError: there is nothing at the path.
    """
    if not path.exists():
        raise DataAbsentError(f"DATA IS ABSENT: no {path}\n{instructions}")
    return path
