"""Putative mirror pairs from files: six columns, x y z of one point and of the other."""

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import npy, parsing, table

COLUMNS = 6
TEXTS = (".csv", ".txt", ".xyz")
FORMATS = (*TEXTS, ".npy")


class PairFile(NamedTuple):
    """Pairs in the file's own units, and a sentence on how they were read."""

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    note: str


def read_pairs(path: str | os.PathLike[str]) -> PairFile:
    """Read pairs, one a row: from CSV, TXT or XYZ (see `symjax.io.table.read`), or NPY.

    Like the readers of points, it is strict: a row of other than six numbers is an error.

    Raises:
        FileFormatError: the file is missing, unreadable, empty, shorter or longer than its header says, or
            holds no rows of six numbers.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    try:
        if path.exists() and not path.is_file():
            raise FileFormatError("it is a folder; give a file" if path.is_dir() else "it is no regular file")
        if suffix not in FORMATS:
            raise FileFormatError(f"pairs are read from {', '.join(FORMATS)}, not from {suffix!r}")
        rows = npy.read(path, COLUMNS) if suffix == ".npy" else _read_text(path.read_bytes())
        if not len(rows):
            raise FileFormatError("it holds no pairs")
    except FileFormatError as error:
        raise FileFormatError(f"cannot read pairs from {str(path)!r}: {error}") from error
    except OSError as error:
        raise FileFormatError(f"cannot read pairs from {str(path)!r}: {error.strerror or error}") from error
    return PairFile(rows[:, :3], rows[:, 3:], f"{len(rows)} pairs")


def _read_text(data: bytes) -> Float[np.ndarray, "n 6"]:
    found = table.read(data)
    if found.rows and found.num_columns != COLUMNS:
        raise FileFormatError(
            f"row 1 of its data, {parsing.shown(found.rows[0])}, has {found.num_columns} columns: {COLUMNS} expected, "
            "x y z of one point and of the other"
        )
    return table.numbers(found, range(COLUMNS))[0]
