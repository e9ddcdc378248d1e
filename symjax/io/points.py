"""Reading of point clouds and meshes, and writing of point clouds.

All readers are strict: they refuse a file whose content does not match its header, to the byte. A truncated cloud would
have another mirror plane, and the error would go unnoticed.
"""

import os
import stat
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.geometry.checks import as_path, whole
from symjax.geometry.point_arrays import as_points
from symjax.geometry.seeds import Seed, seeded
from symjax.io import mesh, npy, text
from symjax.io.atomic import replacing
from symjax.io.formats import (
    gltf,
    obj_off_stl,
    pcd,
    ply,
)

NUM_SAMPLES = 20_000
"""Points sampled from a mesh by default: dense enough for the resolution of `detect`, and fast."""

MESHES = {
    ".ply": ply.read,
    ".obj": obj_off_stl.read_obj,
    ".off": obj_off_stl.read_off,
    ".stl": obj_off_stl.read_stl,
    ".glb": gltf.read,
}
CLOUDS = {
    ".xyz": text.read,
    ".txt": text.read,
    ".csv": text.read,
    ".pcd": pcd.read,
}
FORMATS = (
    "PLY",
    "OBJ",
    "OFF",
    "STL",
    "GLB",
    "XYZ",
    "TXT",
    "CSV",
    "NPY",
    "PCD",
)
"""Formats, which are also the extensions, in the order of error messages."""

SIGNATURES = {
    b"ply\n": "PLY",
    b"ply\r": "PLY",
    b"OFF": "OFF",
    npy.MAGIC: "NPY",
    b"# .PCD": "PCD",
    b"glTF": "GLB",
    b"PK\x03\x04": "ZIP",
}


class PointFile(NamedTuple):
    """Points read from a file.

    Attributes:
        points: the points, in the units of the file.
        note: how the file was read, such as "mesh of 5856 faces, sampled uniformly by area: 20000 points".
    """

    points: Float[np.ndarray, "n 3"]
    note: str


def read_points(path: str | os.PathLike[str], *, num_samples: int = NUM_SAMPLES, rng: Seed = 0) -> PointFile:
    """Reads a point cloud from a file, or samples one from a mesh.

    Meshes in PLY, OBJ, OFF, STL and GLB are sampled uniformly by area. Clouds are read from these formats if they have
    no faces, and from XYZ, TXT and CSV (three or more columns, any usual delimiter, an optional header line), NPY and
    PCD. The content of a file is never executed, and no other file is opened.

    Args:
        path: file to read; its extension, in upper or lower case, determines the format.
        num_samples: number of points to sample from a mesh.
        rng: seed or generator of the sampling.

    Returns:
        The points as float64, in the units of the file, and a note on how they were read.

    Raises:
        FileFormatError: if the file is missing, unreadable, empty, damaged, or not of the format that its extension
            says, or if the format is not supported.
        InvalidArgumentError: if `num_samples` is not a whole number, at least 1, or `rng` is not a valid seed.

    Example:
        >>> from pathlib import Path
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     path = Path(folder) / "scan.csv"
        ...     np.savetxt(path, [[0.0, 0.0, 1.0], [0.5, 2.0, 3.0]], delimiter=",")
        ...     points, note = read_points(path)
        >>> points
        array([[0. , 0. , 1. ],
               [0.5, 2. , 3. ]])
        >>> note
        'cloud of 2 points'
    """
    whole("num_samples", num_samples, 1)
    generator = seeded(rng).generator
    path = as_path(path)
    suffix = path.suffix.lower()
    try:
        _check_file(path, suffix)
        # the conversion of a signalling NaN would warn; `detect` decides what to do with NaN
        with np.errstate(invalid="ignore"):
            if suffix in MESHES:
                return _sample(MESHES[suffix](path.read_bytes()), num_samples, generator)
            points, note = (npy.read(path, 3), "") if suffix == ".npy" else CLOUDS[suffix](path.read_bytes())
        return _cloud(points, note)
    except FileFormatError as error:
        raise FileFormatError(f"cannot read {str(path)!r}: {error}{_hint(path, suffix)}") from error
    except OSError as error:
        raise FileFormatError(f"cannot read {str(path)!r}: {error.strerror or error}") from error
    except MemoryError as error:
        raise FileFormatError(f"cannot read {str(path)!r}: it does not fit into memory") from error


def _check_file(path: Path, suffix: str) -> None:
    try:
        status = path.stat()
    except ValueError as error:
        raise FileFormatError("this is not a valid file name") from error
    mode, size = status.st_mode, status.st_size
    if stat.S_ISDIR(mode):
        raise FileFormatError("it is a folder: pass a file")
    if suffix != ".npy" and suffix not in MESHES and suffix not in CLOUDS:
        raise FileFormatError(f"the extension {suffix!r} is not supported: use one of {', '.join(FORMATS)}")
    if not stat.S_ISREG(mode):
        raise FileFormatError("it is not a regular file")
    if size == 0:
        raise FileFormatError("the file is empty")


def _sample(solid: mesh.Mesh, num_samples: int, rng: np.random.Generator) -> PointFile:
    if len(solid.triangles) == 0:
        return _cloud(solid.vertices, "")
    parts = f" in {solid.num_parts} parts, merged" if solid.num_parts > 1 else ""
    note = f"mesh of {solid.num_faces} faces{parts}, sampled uniformly by area: {num_samples} points"
    unused = len(solid.vertices) - np.count_nonzero(np.bincount(solid.triangles.ravel()))
    if unused:
        note += f"; unused vertices ignored: {unused}"
    return PointFile(mesh.sample(solid, num_samples, rng), note)


def _cloud(points: Float[np.ndarray, "n 3"], note: str) -> PointFile:
    if len(points) == 0:
        raise FileFormatError("it contains no points" + (f" ({note})" if note else ""))
    return PointFile(points, f"cloud of {len(points)} points" + (f"; {note}" if note else ""))


def _hint(path: Path, suffix: str) -> str:
    """Returns a hint if the file starts like one of another format."""
    if not path.is_file():
        return ""
    with path.open("rb") as stream:
        start = stream.read(8)
    found = next((name for signature, name in SIGNATURES.items() if start.startswith(signature)), suffix[1:].upper())
    if found == suffix[1:].upper():
        return ""
    return f"; its content looks like {found}: " + ("unpack it" if found == "ZIP" else f"rename it to .{found.lower()}")


def write_points(path: str | os.PathLike[str], points: ArrayLike, *, force: bool = False) -> None:
    """Writes a cloud as binary PLY in float64. The file appears only when it is complete.

    Args:
        path: file to write, with the extension .ply.
        points: the cloud, of shape (n, 3).
        force: whether to replace an existing file.

    Raises:
        InvalidArgumentError: if the extension is not .ply, the file exists, or it cannot be written.
        InvalidPointsError: if `points` is not an (n, 3) array of real numbers, or is empty.
    """
    target = as_path(path)
    points = as_points(points)
    if target.suffix.lower() != ".ply":
        raise InvalidArgumentError(
            f"cannot write {str(target)!r}: points are written as PLY, so the name must end in .ply"
        )
    if target.exists() and not force:
        raise InvalidArgumentError(f"cannot write {str(target)!r}: it exists; pass force=True to replace it")
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        "property double x\nproperty double y\nproperty double z\nend_header\n"
    )
    with replacing(target) as temporary:
        temporary.write_bytes(header.encode() + points.astype("<f8").tobytes())
