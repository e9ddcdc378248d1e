"""A table of numbers written as text: one row a line, perhaps below a line of names."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing

QUOTED = re.compile(r'"[^"]*"')


class Table(NamedTuple):
    """Lines of equally many cells.

    Attributes:
        names: of the columns, in lower case; empty where no line of names comes first.
        rows: the other lines.
        delimiter: what stands between two cells; None for white space.
        num_columns: cells of a row.
    """

    names: list[str]
    rows: list[str]
    delimiter: str | None
    num_columns: int


def read(data: bytes) -> Table:
    """The table in a text file.

    Blank lines, and lines that start with #, are comments. Columns are separated by semicolons, commas or white space,
    as in the first rows. The first line is a line of names if none of its cells is a number.

    Raises:
        FileFormatError: the bytes are not text, or a row has more or fewer cells than the first.
    """
    rows = [line.strip() for line in parsing.lines(data) if line.strip() and not line.lstrip().startswith("#")]
    delimiter = next((mark for mark in ";," if any(mark in row for row in rows[1:2] or rows)), None)
    names = _names(rows[0], delimiter) if rows else []
    rows = rows[1:] if names else rows
    num_columns = len(_cells(rows[0], delimiter)) if rows else 0
    for number, row in enumerate(rows, start=1):
        if (count := len(_cells(row, delimiter))) != num_columns:
            raise FileFormatError(
                f"row {number} of its data, {parsing.shown(row)}, has {count} columns: {num_columns} expected"
            )
    return Table(names, rows, delimiter, num_columns)


def numbers(table: Table, columns: Sequence[int]) -> tuple[Float[np.ndarray, "n k"], bool]:
    """The chosen columns as float64, and whether the file has decimal commas: it may where semicolons separate columns.

    Raises:
        FileFormatError: a cell is not a number, or some numbers have a decimal comma and others a decimal point.
    """
    rows, has_commas = table.rows, False
    if table.delimiter == ";" and any("," in row for row in rows):
        chosen = [" ".join(_cells(row, ";")[column] for column in columns) for row in rows]
        has_commas = any("," in row for row in chosen)
        if has_commas and any("." in row for row in chosen):
            first = next(number for number, row in enumerate(chosen) if "," in row)
            raise FileFormatError(
                f"decimal points and commas in one file (row {first + 1} of its data is {parsing.shown(rows[first])}): "
                "write all numbers with points"
            )
        rows = [row.replace(",", ".") for row in rows]
    return parsing.parse(rows, columns, delimiter=table.delimiter, quotechar='"'), has_commas


def _cells(row: str, delimiter: str | None) -> list[str]:
    """The cells of a row. A delimiter at its end makes no cell, and one between quotes is none."""
    if '"' in row:
        inner = re.escape(delimiter) if delimiter else r"\s"
        row = QUOTED.sub(lambda quoted: re.sub(inner, "_", quoted[0]), row)
    return (row.removesuffix(delimiter) if delimiter else row).split(delimiter)


def _names(row: str, delimiter: str | None) -> list[str]:
    """The names in a line of names, in lower case; empty if any cell is a number."""
    names = [cell.strip(' "/,;').lower() for cell in _cells(row, delimiter)]
    if delimiter is None:
        # the mark of a comment, "// x y z", is no name
        names = [name for name in names if name]
    for name in names:
        try:
            float(name.replace(",", "."))
        except ValueError:
            continue
        return []
    return names
