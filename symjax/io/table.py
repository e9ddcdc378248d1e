"""Text tables: one row of numbers per line, optionally below a header line of column names."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing


class Table(NamedTuple):
    """A table in which all rows have the same number of columns.

    Attributes:
        names: lower-case names of the columns; empty if the table has no header line.
        rows: lines of the table without the header line.
        delimiter: text between two columns; None for white space.
        num_columns: number of columns of each row.
    """

    names: list[str]
    rows: parsing.Rows
    delimiter: str | None
    num_columns: int


def read(data: bytes) -> Table:
    """Reads a table from a text file.

    Blank lines, and lines that start with #, are ignored. The delimiter is the semicolon, the comma or white space,
    whichever the first rows use. The first line is a header line if none of its cells is a number.

    Raises:
        FileFormatError: if the file is not text, or the rows differ in their number of columns.
    """
    rows = parsing.rows(data, clean=_without_comment)
    delimiter = next((mark for mark in ";," if any(mark in row for row in rows.texts[1:2] or rows.texts)), None)
    names = _names(rows.texts[0], delimiter) if len(rows) else []
    rows = rows[1:] if names else rows
    num_columns = len(parsing.cells(rows.texts[0], delimiter)) if len(rows) else 0
    for row, number in zip(rows.texts, rows.numbers, strict=True):
        if (count := len(parsing.cells(row, delimiter))) != num_columns:
            raise FileFormatError(
                f"line {number}: expected {num_columns} columns as in line {rows.numbers[0]}, "
                f"found {count} in {parsing.shown(row)}"
            )
    return Table(names, rows, delimiter, num_columns)


def numbers(table: Table, columns: Sequence[int]) -> tuple[Float[np.ndarray, "n k"], bool]:
    """Converts some columns to float64.

    Args:
        table: the table.
        columns: columns to convert, counted from 0.

    Returns:
        The numbers, and whether they are written with decimal commas. Decimal commas are only recognised if semicolons
        separate the columns.

    Raises:
        FileFormatError: if a cell is not a number, or decimal points and decimal commas are mixed.
    """
    rows, has_commas = table.rows, False
    if table.delimiter == ";" and any("," in row for row in rows.texts):
        chosen = [" ".join(parsing.cells(row, ";")[column] for column in columns) for row in rows.texts]
        has_commas = any("," in row for row in chosen)
        if has_commas and any("." in row for row in chosen):
            first = next(index for index, row in enumerate(chosen) if "," in row)
            raise FileFormatError(
                f"line {rows.numbers[first]}: {parsing.shown(rows.texts[first])} has a decimal comma, but other "
                "numbers have decimal points: write all numbers with decimal points"
            )
        rows = parsing.Rows([row.replace(",", ".") for row in rows.texts], rows.numbers)
    return parsing.parse(rows, columns, delimiter=table.delimiter, quotechar='"'), has_commas


def _without_comment(line: str) -> str:
    return "" if line.lstrip().startswith("#") else line.strip()


def _names(row: str, delimiter: str | None) -> list[str]:
    """Returns the lower-case cells of a header line, or an empty list if any cell is a number."""
    names = [cell.strip(' "/,;').lower() for cell in parsing.cells(row, delimiter)]
    if delimiter is None:
        # the comment mark in "// x y z" is no name
        names = [name for name in names if name]
    for name in names:
        try:
            float(name.replace(",", "."))
        except ValueError:
            continue
        return []
    return names
