"""Putative mirror pairs from files with six columns, x y z of one point and x y z of the other."""

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
    """Pairs read from a file.

    Attributes:
        x: one point of each pair, in the units of the file.
        y: the other point of each pair.
        note: how the file was read, as a phrase.
    """

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    note: str


def read_pairs(path: str | os.PathLike[str]) -> PairFile:
    """Reads pairs, one per row, from CSV, TXT or XYZ (see `symjax.io.table.read`) or NPY.

    Args:
        path: file to read; its extension determines the format.

    Returns:
        The pairs, and a note.

    Raises:
        FileFormatError: if the file is missing, unreadable, empty, damaged or of another format, or a row does not
            consist of six numbers.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    try:
        if path.exists() and not path.is_file():
            raise FileFormatError("it is a folder: pass a file" if path.is_dir() else "it is not a regular file")
        if suffix not in FORMATS:
            raise FileFormatError(f"the extension {suffix!r} is not supported: use one of {', '.join(FORMATS)}")
        rows = npy.read(path, COLUMNS) if suffix == ".npy" else _read_text(path.read_bytes())
        if not len(rows):
            raise FileFormatError("it contains no pairs")
    except FileFormatError as error:
        raise FileFormatError(f"cannot read pairs from {str(path)!r}: {error}") from error
    except OSError as error:
        raise FileFormatError(f"cannot read pairs from {str(path)!r}: {error.strerror or error}") from error
    return PairFile(rows[:, :3], rows[:, 3:], f"{len(rows)} pairs")


def _read_text(data: bytes) -> Float[np.ndarray, "n 6"]:
    found = table.read(data)
    if len(found.rows) and found.num_columns != COLUMNS:
        raise FileFormatError(
            f"line {found.rows.numbers[0]}: expected {COLUMNS} columns (x y z of one point, x y z of the other), "
            f"found {found.num_columns} in {parsing.shown(found.rows.texts[0])}"
        )
    return table.numbers(found, range(COLUMNS))[0]
