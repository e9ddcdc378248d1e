"""Point clouds as plain text: XYZ, TXT and CSV, one point a line."""

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing


def read(data: bytes) -> tuple[Float[np.ndarray, "n 3"], str]:
    """Points, and how the columns were understood.

    Lines that start with # are comments. Columns are parted by semicolons, commas or white space, as the first row
    has them; with semicolons, a comma is a decimal comma. One header line may come first: if it names columns x, y
    and z, those are taken, else the first three.

    Raises:
        FileFormatError: fewer than 3 columns, a row that is no row of numbers, or a last row shorter than the first.
    """
    rows = [line for line in parsing.lines(data) if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise FileFormatError("no points: nothing but blank lines and comments")
    first = rows[1] if len(rows) > 1 else rows[0]
    delimiter = next((mark for mark in ";," if mark in first), None)
    columns = (0, 1, 2)
    notes = []
    header = _header(rows[0], delimiter)
    is_named = {"x", "y", "z"} <= set(header)
    if header:
        rows = rows[1:]
        if not rows:
            raise FileFormatError(f"no points: one line only, {parsing.shown(header[0])}...")
        if is_named:
            columns = (header.index("x"), header.index("y"), header.index("z"))
    num_columns = len(_cells(rows[0], delimiter))
    if num_columns < 3:
        raise FileFormatError(f"{num_columns} column(s) in {parsing.shown(rows[0])}: at least 3 expected")
    if len(_cells(rows[-1], delimiter)) < num_columns:
        raise FileFormatError(f"the last row is cut short: {parsing.shown(rows[-1])}")
    if delimiter == ";" and "," in rows[0]:
        rows = [row.replace(",", ".") for row in rows]
        notes.append("decimal commas")
    if num_columns > 3:
        taken = "x, y, z by name" if is_named else "the first 3"
        notes.append(f"{num_columns} columns, of which {taken} were used")
    return parsing.parse(rows, columns, delimiter=delimiter, quotechar='"'), "; ".join(notes)


def _cells(row: str, delimiter: str | None) -> list[str]:
    """The cells of a row; one more delimiter at its end makes no cell."""
    row = row.strip()
    return (row.removesuffix(delimiter) if delimiter else row).split(delimiter)


def _header(row: str, delimiter: str | None) -> list[str]:
    """The names in a header line, in lower case; empty if any cell is a number."""
    names = [cell.strip(' "/,;').lower() for cell in _cells(row, delimiter)]
    for name in names:
        try:
            float(name.replace(",", "."))
        except ValueError:
            continue
        return []
    return names
