"""Rows of numbers written as text, parsed strictly: a short or unreadable row is an error, never a shorter table."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError

SHOWN = 60
"""Characters of an offending row that an error message shows."""


def lines(data: bytes) -> list[str]:
    """The lines of a text file, whatever its line ends.

    Latin-1 takes every byte as one character: no encoding of a comment or a header can fail, and numbers are ASCII.

    Raises:
        FileFormatError: the bytes are not text.
    """
    if b"\0" in data:
        raise FileFormatError("binary content where text was expected")
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def parse(
    rows: Sequence[str], columns: Sequence[int], *, delimiter: str | None = None, quotechar: str | None = None
) -> Float[np.ndarray, "n k"]:
    """The chosen columns of every row, as float64.

    Args:
        rows: lines of text, one row of numbers each, none of them blank.
        columns: which columns to take, counted from 0.
        delimiter: what stands between columns; white space by default.
        quotechar: what cells may be quoted with.

    Raises:
        FileFormatError: a row lacks one of the columns or holds something that is not a number there.
    """
    if not rows:
        return np.empty((0, len(columns)))
    try:
        values = np.loadtxt(rows, usecols=columns, delimiter=delimiter, quotechar=quotechar, comments=None, ndmin=2)
    except ValueError as error:
        raise FileFormatError(_complaint(rows, columns, delimiter, quotechar)) from error
    if len(values) != len(rows):
        raise FileFormatError(f"{len(rows)} rows of numbers expected, {len(values)} read")
    return values


def _complaint(rows: Sequence[str], columns: Sequence[int], delimiter: str | None, quotechar: str | None) -> str:
    """Which row could not be parsed: found by a second, slow pass that only a bad file pays for."""
    for number, row in enumerate(rows, start=1):
        cells = row.split(delimiter)
        try:
            for column in columns:
                float(cells[column].strip(quotechar))
        except (ValueError, IndexError):
            return f"row {number} of its data is {shown(row)}: {len(columns)} numbers expected"
    return "its rows of numbers cannot be parsed"


def shown(text: str) -> str:
    """A piece of a file as an error message shows it: quoted, on one line, not long."""
    return ascii(text if len(text) <= SHOWN else text[:SHOWN] + "...")
