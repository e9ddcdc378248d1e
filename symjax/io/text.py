"""Point clouds as plain text: XYZ, TXT and CSV, with one point per line."""

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing, table


def read(data: bytes) -> tuple[Float[np.ndarray, "n 3"], str]:
    """Reads a cloud from a text table, see `symjax.io.table.read`.

    If the header line names columns x, y and z, these are the coordinates; otherwise the first three columns are.

    Returns:
        The points, and a note on decimal commas and further columns.

    Raises:
        FileFormatError: if there are fewer than 3 columns, a coordinate is not a number, or the rows differ in their
            number of columns.
    """
    found = table.read(data)
    if not len(found.rows):
        names = f"a header line: {parsing.shown(' '.join(found.names))}" if found.names else "blank lines and comments"
        raise FileFormatError(f"it contains no points, only {names}")
    if found.num_columns < 3:
        raise FileFormatError(
            f"line {found.rows.numbers[0]}: expected at least 3 columns (x y z), "
            f"found {found.num_columns} in {parsing.shown(found.rows.texts[0])}"
        )
    is_named = {"x", "y", "z"} <= set(found.names[: found.num_columns])
    columns = [found.names.index(axis) for axis in "xyz"] if is_named else [0, 1, 2]
    points, has_commas = table.numbers(found, columns)
    notes = ["decimal commas"] if has_commas else []
    if found.num_columns > 3:
        used = "x, y, z by name" if is_named else "the first 3"
        notes.append(f"{found.num_columns} columns, of which {used} were used")
    return points, "; ".join(notes)
