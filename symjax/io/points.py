"""Point clouds and meshes from files, and clouds to files.

Every reader is strict: what a header promises must be there, to the byte, or the file is refused. A partial cloud
has another mirror plane, and nobody would know.
"""

import os
import stat
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError, InvalidArgumentError, InvalidPointsError
from symjax.io import mesh, npy, text
from symjax.io.atomic import replacing
from symjax.io.formats import gltf, obj_off_stl, pcd, ply

NUM_SAMPLES = 20_000
"""Points sampled from a mesh: dense enough for what `detect` resolves, and quick."""

MESHES = {
    ".ply": ply.read,
    ".obj": obj_off_stl.read_obj,
    ".off": obj_off_stl.read_off,
    ".stl": obj_off_stl.read_stl,
    ".glb": gltf.read,
}
CLOUDS = {".pcd": pcd.read, ".xyz": text.read, ".txt": text.read, ".csv": text.read}
FORMATS = ("PLY", "OBJ", "OFF", "STL", "GLB", "XYZ", "TXT", "CSV", "NPY", "PCD")
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
    """Points in the file's own units, and a sentence on how they were read."""

    points: Float[np.ndarray, "n 3"]
    note: str


def read_points(
    path: str | os.PathLike[str], *, num_samples: int = NUM_SAMPLES, rng: int | np.integer | np.random.Generator = 0
) -> PointFile:
    """Read a point cloud, or sample one from a mesh.

    PLY, OBJ, OFF, STL and GLB with faces are sampled uniformly by area; everything else is taken as it is. Read are
    also XYZ, TXT and CSV (three columns or more, any usual delimiter, one header line), NPY and PCD. Nothing in a file
    is ever executed, and no other file is opened for it.

    Args:
        path: file to read; its extension, in any case, says the format.
        num_samples: points to sample from a mesh.
        rng: seed or generator of the sampling.

    Returns:
        The points as float64, and a note such as "mesh of 5856 faces, sampled uniformly by area: 20000 points".

    Raises:
        FileFormatError: the file is missing, unreadable, empty, truncated, of another format than its name says, or
            of one that is not read.
        InvalidArgumentError: `num_samples` is not positive, or `rng` is no seed.
    """
    if num_samples < 1:
        raise InvalidArgumentError(f"num_samples must be at least 1, got {num_samples}")
    try:
        generator = np.random.default_rng(rng)
    except (TypeError, ValueError) as error:
        raise InvalidArgumentError(f"rng must be a seed, not negative, or a numpy Generator, not {rng!r}") from error
    path = Path(path)
    suffix = path.suffix.lower()
    try:
        _check_file(path, suffix)
        # a signalling NaN warns when it is widened; NaN is for `detect` to judge
        with np.errstate(invalid="ignore"):
            if suffix in MESHES:
                return _sampled(MESHES[suffix](path.read_bytes()), num_samples, generator)
            points, note = (npy.read(path, 3), "") if suffix == ".npy" else CLOUDS[suffix](path.read_bytes())
        return _taken(points, note)
    except FileFormatError as error:
        raise FileFormatError(f"cannot read {str(path)!r}: {error}{_other_format(path, suffix)}") from error
    except OSError as error:
        raise FileFormatError(f"cannot read {str(path)!r}: {error.strerror or error}") from error
    except MemoryError as error:
        raise FileFormatError(f"cannot read {str(path)!r}: it does not fit into memory") from error


def _check_file(path: Path, suffix: str) -> None:
    try:
        status = path.stat()
    except ValueError as error:
        raise FileFormatError("no file can have this name") from error
    mode, size = status.st_mode, status.st_size
    if stat.S_ISDIR(mode):
        raise FileFormatError("it is a folder; give a file")
    if suffix != ".npy" and suffix not in MESHES and suffix not in CLOUDS:
        raise FileFormatError(f"the extension {suffix!r} is not one that is read ({', '.join(FORMATS)})")
    if not stat.S_ISREG(mode):
        raise FileFormatError("it is no regular file")
    if size == 0:
        raise FileFormatError("the file is empty")


def _sampled(solid: mesh.Mesh, num_samples: int, rng: np.random.Generator) -> PointFile:
    if len(solid.triangles) == 0:
        return _taken(solid.vertices, "")
    parts = f" in {solid.num_parts} parts, merged" if solid.num_parts > 1 else ""
    note = f"mesh of {solid.num_faces} faces{parts}, sampled uniformly by area: {num_samples} points"
    loose = len(solid.vertices) - np.count_nonzero(np.bincount(solid.triangles.ravel()))
    if loose:
        note += f"; {loose} loose vertices left out"
    return PointFile(mesh.sample(solid, num_samples, rng), note)


def _taken(points: Float[np.ndarray, "n 3"], note: str) -> PointFile:
    if len(points) == 0:
        raise FileFormatError("it holds no points" + (f" ({note})" if note else ""))
    return PointFile(points, f"cloud of {len(points)} points" + (f"; {note}" if note else ""))


def _other_format(path: Path, suffix: str) -> str:
    """A hint if a readable file starts like one of another format."""
    if not path.is_file():
        return ""
    with path.open("rb") as stream:
        start = stream.read(8)
    found = next((name for signature, name in SIGNATURES.items() if start.startswith(signature)), suffix[1:].upper())
    return "" if found == suffix[1:].upper() else f"; its content looks like {found}"


def write_points(path: str | os.PathLike[str], points: Float[np.ndarray, "n 3"], *, force: bool = False) -> None:
    """Write a cloud as binary PLY in float64; it appears under its name only when it is complete.

    Args:
        path: file to write, with the extension .ply.
        points: the cloud.
        force: replace a file that exists.

    Raises:
        InvalidArgumentError: the extension is another, the file exists, or it cannot be written.
        InvalidPointsError: `points` is not of shape (n, 3).
    """
    target = Path(path)
    points = np.asarray(points)
    if points.ndim != 2 or points.shape[1] != 3 or points.dtype.kind not in "fiu":
        raise InvalidPointsError(f"points must be real numbers of shape (n, 3), got {points.dtype} {points.shape}")
    if target.suffix.lower() != ".ply":
        raise InvalidArgumentError(f"cannot write {str(target)!r}: points are written as PLY; end the name in .ply")
    if target.exists() and not force:
        raise InvalidArgumentError(f"cannot write {str(target)!r}: it exists; use force to replace it")
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
        "property double x\nproperty double y\nproperty double z\nend_header\n"
    )
    with replacing(target) as temporary:
        temporary.write_bytes(header.encode() + points.astype("<f8").tobytes())
