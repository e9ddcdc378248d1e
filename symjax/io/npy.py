"""NumPy's NPY format, with one point or one pair per row."""

import warnings
from pathlib import Path

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError

MAGIC = b"\x93NUMPY"


def read(path: Path, num_columns: int) -> Float[np.ndarray, "n k"]:
    """Reads an array of shape (n, num_columns) as float64.

    The file is memory-mapped first, so a header that declares too many rows costs no memory.

    Raises:
        FileFormatError: if the file is not an NPY file, contains pickled objects, has another shape, is not of real
            numbers, or has more or fewer bytes than its header declares.
        OSError: if the file cannot be opened.
    """
    with path.open("rb") as stream:
        if stream.read(len(MAGIC)) != MAGIC:
            raise FileFormatError("it is not an NPY file: it does not start with '\\x93NUMPY'")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mapped = np.lib.format.open_memmap(path, mode="r")
    except OSError:
        raise
    # NumPy evaluates the header as Python source, so a damaged one can raise anything
    except Exception as error:
        raise FileFormatError(
            "the NPY header is damaged, declares more data than the file contains, or declares pickled objects, "
            "which are not read"
        ) from error
    if mapped.dtype.kind not in "fiu" or mapped.ndim != 2 or mapped.shape[1] != num_columns:
        raise FileFormatError(
            f"expected real numbers of shape (n, {num_columns}), found {mapped.dtype} of shape {mapped.shape}"
        )
    if extra := path.stat().st_size - mapped.offset - mapped.nbytes:
        raise FileFormatError(
            f"expected {len(mapped)} rows as the NPY header declares, found {extra} bytes after them: "
            "the file is damaged"
        )
    return np.array(mapped, dtype=np.float64, order="C")
