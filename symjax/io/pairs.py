"""Putative mirror pairs from files: six columns, x y z of one point and of the other."""

import os
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing

COLUMNS = 6
TEXTS = (".csv", ".txt", ".xyz")
FORMATS = (*TEXTS, ".npy")


class PairFile(NamedTuple):
    """Pairs in the file's own units, and a sentence on how they were read."""

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    note: str


def read_pairs(path: str | os.PathLike[str]) -> PairFile:
    """Read pairs, one a row: from CSV, TXT or XYZ (parted by commas, semicolons or white space), or NPY.

    Text may begin with one line of names, and lines that start with # are comments. Like the readers of points, it is
    strict: a row of other than six numbers is an error.

    Raises:
        FileFormatError: the file is missing, unreadable, empty, cut short, or holds no rows of six numbers.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    try:
        if path.exists() and not path.is_file():
            raise FileFormatError("it is a folder; give a file" if path.is_dir() else "it is no regular file")
        if suffix not in FORMATS:
            raise FileFormatError(f"pairs are read from {', '.join(FORMATS)}, not from {suffix!r}")
        rows = _read_npy(path) if suffix == ".npy" else _read_text(path.read_bytes())
    except FileFormatError as error:
        raise FileFormatError(f"cannot read pairs from {str(path)!r}: {error}") from error
    except OSError as error:
        raise FileFormatError(f"cannot read pairs from {str(path)!r}: {error.strerror or error}") from error
    return PairFile(rows[:, :3], rows[:, 3:], f"{len(rows)} pairs")


def _read_text(data: bytes) -> Float[np.ndarray, "n 6"]:
    rows = [line.strip() for line in parsing.lines(data) if line.strip() and not line.lstrip().startswith("#")]
    delimiter = next((mark for mark in ";," if rows and mark in rows[-1]), None)
    if rows and _is_header(rows[0], delimiter):
        rows = rows[1:]
    if not rows:
        raise FileFormatError("it holds no pairs")
    for number, row in enumerate(rows, start=1):
        if (count := len(row.split(delimiter))) != COLUMNS:
            raise FileFormatError(
                f"row {number} of its data, {parsing.shown(row)}, has {count} columns: {COLUMNS} expected, "
                "x y z of one point and of the other"
            )
    return parsing.parse(rows, range(COLUMNS), delimiter=delimiter, quotechar='"')


def _is_header(row: str, delimiter: str | None) -> bool:
    """Whether no cell is a number."""
    for cell in row.split(delimiter):
        try:
            float(cell.strip().strip('"'))
        except ValueError:
            continue
        return False
    return True


def _read_npy(path: Path) -> Float[np.ndarray, "n 6"]:
    """An array of shape (n, 6); mapped, not loaded, so that its header cannot claim memory."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mapped = np.lib.format.open_memmap(path, mode="r")
    except OSError:
        raise
    # NumPy reads the header as Python source: what a damaged one raises is anybody's guess
    except Exception as error:
        raise FileFormatError("it is no NPY file, or asks for pickled objects, or is cut short") from error
    if mapped.dtype.kind not in "fiu" or mapped.ndim != 2 or mapped.shape[1] != COLUMNS or not len(mapped):
        raise FileFormatError(f"{mapped.dtype} of shape {mapped.shape}: real numbers of shape (n, {COLUMNS}) expected")
    return np.array(mapped, dtype=np.float64, order="C")
