"""NumPy's own format: one array of points, or of pairs, a row each."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError

MAGIC = b"\x93NUMPY"


def read(path: Path, num_columns: int) -> Float[np.ndarray, "n k"]:
    """An array of shape (n, num_columns) as float64; mapped, not loaded, until its header is known to tell the truth.

    Raises:
        FileFormatError: no NPY file, pickled objects, another shape, no real numbers, or more or fewer bytes than the
            header promises.
        OSError: the file cannot be opened.
    """
    with path.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise FileFormatError("no NPY file: it does not start with '\\x93NUMPY'")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mapped = np.lib.format.open_memmap(path, mode="r")
    except OSError:
        raise
    # NumPy reads the header as Python source: what a damaged one raises is anybody's guess
    except Exception as error:
        raise FileFormatError(
            "its header is damaged, asks for pickled objects, or promises more than is there"
        ) from error
    if mapped.dtype.kind not in "fiu" or mapped.ndim != 2 or mapped.shape[1] != num_columns:
        expected = f"real numbers of shape (n, {num_columns}) expected"
        raise FileFormatError(f"an array of {mapped.dtype}, of shape {mapped.shape}: {expected}")
    if mapped.offset + mapped.nbytes != path.stat().st_size:
        raise FileFormatError(f"{len(mapped)} rows are promised, and the file is longer than that")
    return np.array(mapped, dtype=np.float64, order="C")
