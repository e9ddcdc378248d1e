"""Strict parsing of text with one row of numbers per line: a malformed row is an error, and no row is skipped."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError

SHOWN = 60
"""Longest excerpt of a file in an error message, in characters."""

QUOTED = re.compile(r'"[^"]*"')


@dataclass(frozen=True)
class Rows:
    """Lines of a file.

    Attributes:
        texts: content of each line.
        numbers: number of each line in the file, counted from 1.
    """

    texts: list[str]
    numbers: list[int]

    def __len__(self) -> int:
        """Number of lines."""
        return len(self.texts)

    def __getitem__(self, part: slice) -> "Rows":
        """Some of the lines."""
        return Rows(self.texts[part], self.numbers[part])


def lines(data: bytes) -> list[str]:
    """Splits a text file into lines at any usual line end.

    The text is decoded as Latin-1, which maps each byte to one character. Comments and headers in any encoding are thus
    accepted, and numbers are ASCII.

    Raises:
        FileFormatError: if the file contains NUL bytes.
    """
    if b"\0" in data:
        raise FileFormatError("it contains NUL bytes: a text file must be ASCII or UTF-8")
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def rows(data: bytes, *, first: int = 1, clean: Callable[[str], str] = str.strip) -> Rows:
    """Returns the lines that are not blank.

    Args:
        data: content of the file, or the rest of it.
        first: number of the first line of `data` in the file.
        clean: function that removes comments and surrounding space from a line.

    Raises:
        FileFormatError: if the file contains NUL bytes.
    """
    cleaned = [clean(line) for line in lines(data)]
    numbers = [first + i for i, text in enumerate(cleaned) if text]
    return Rows([text for text in cleaned if text], numbers)


def cells(row: str, delimiter: str | None) -> list[str]:
    """Splits a row at the delimiter, or at white space if it is None.

    A delimiter at the end of the row is ignored; one between quotes becomes an underscore.
    """
    if '"' in row:
        inner = re.escape(delimiter) if delimiter else r"\s"
        row = QUOTED.sub(lambda quoted: re.sub(inner, "_", quoted[0]), row)
    return (row.removesuffix(delimiter) if delimiter else row).split(delimiter)


def parse(
    rows: Rows, columns: Sequence[int], *, delimiter: str | None = None, quotechar: str | None = None
) -> Float[np.ndarray, "n k"]:
    """Converts some columns of all rows to float64.

    Args:
        rows: lines with one row of numbers each.
        columns: columns to convert, counted from 0.
        delimiter: text between two columns, or None for white space.
        quotechar: character that may enclose a cell.

    Returns:
        The numbers, one row per line.

    Raises:
        FileFormatError: if a row lacks one of the columns, or the cell there is not a number.
    """
    if not len(rows):
        return np.empty((0, len(columns)))
    try:
        values = np.loadtxt(
            rows.texts, usecols=columns, delimiter=delimiter, quotechar=quotechar, comments=None, ndmin=2
        )
    except ValueError as error:
        raise FileFormatError(_first_fault(rows, columns, delimiter, quotechar)) from error
    if len(values) != len(rows):
        raise FileFormatError(f"expected {len(rows)} rows of numbers, found {len(values)}")
    return values


def _first_fault(rows: Rows, columns: Sequence[int], delimiter: str | None, quotechar: str | None) -> str:
    """Describes the first row that cannot be parsed, in a second pass that is slow and runs for bad files only."""
    for text, number in zip(rows.texts, rows.numbers, strict=True):
        found = cells(text, delimiter)
        if len(found) <= max(columns):
            return f"line {number}: expected at least {max(columns) + 1} columns, found {len(found)} in {shown(text)}"
        for column in columns:
            try:
                float(found[column].strip(quotechar))
            except ValueError:
                return f"line {number}: expected a number in column {column + 1}, found {shown(found[column])}"
    return f"lines {rows.numbers[0]} to {rows.numbers[-1]}: the rows of numbers cannot be parsed"


def shown(text: str) -> str:
    """Returns an excerpt of a file for an error message: quoted, on one line, and not too long."""
    return ascii(text if len(text) <= SHOWN else text[:SHOWN] + "...")
