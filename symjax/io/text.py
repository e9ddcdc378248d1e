"""Point clouds as plain text: XYZ, TXT and CSV, one point a line."""

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing, table


def read(data: bytes) -> tuple[Float[np.ndarray, "n 3"], str]:
    """Points, and how the columns were understood.

    See `symjax.io.table.read` for what a table is. If its columns x, y and z are named, those are taken, else the
    first three. Where semicolons separate columns, a comma is a decimal comma.

    Raises:
        FileFormatError: fewer than 3 columns, a row that is no row of numbers, or one longer or shorter than the first.
    """
    found = table.read(data)
    if not found.rows:
        lines = f"one line only, {parsing.shown(found.names[0])}..." if found.names else "blank lines and comments only"
        raise FileFormatError(f"no points: {lines}")
    if found.num_columns < 3:
        shown = parsing.shown(found.rows[0])
        raise FileFormatError(f"{found.num_columns} column(s) in {shown}: at least 3 expected")
    is_named = {"x", "y", "z"} <= set(found.names[: found.num_columns])
    columns = [found.names.index(axis) for axis in "xyz"] if is_named else [0, 1, 2]
    points, has_commas = table.numbers(found, columns)
    notes = ["decimal commas"] if has_commas else []
    if found.num_columns > 3:
        taken = "x, y, z by name" if is_named else "the first 3"
        notes.append(f"{found.num_columns} columns, of which {taken} were used")
    return points, "; ".join(notes)
