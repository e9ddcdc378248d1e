"""The error for benchmark data that has not been downloaded, with instructions for getting it."""

from pathlib import Path

from symjax.errors import SymjaxError


class DataAbsentError(SymjaxError):
    """The files of a published benchmark do not exist where the loader expects them."""


def require(path: Path, instructions: str) -> Path:
    """Returns the path if it exists.

    Args:
        path: a file or a folder.
        instructions: where to get the data and which layout it must have; part of the error message.

    Raises:
        DataAbsentError: if nothing exists at the path.
    """
    if not path.exists():
        raise DataAbsentError(f"DATA IS ABSENT: no {path}\n{instructions}")
    return path
