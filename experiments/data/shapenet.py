"""Loads the 1 000 ShapeNet models that PRS-Net (Gao et al., TVCG 2020) published planes for.

`1000.txt` has one line per model: its name, and the numbers of its planes, which are not used ("52ffc1… 3,1").
`gt_planes.mat` holds a cell array `gt_planes` with one row per model, in the same order. A row has up to three planes
(a, b, c, d) of ax + by + cz + d = 0, in the frame of ShapeNetCore.v2. The loader normalises them (32 are not of unit
length), skips zero vectors, and keeps the first of planes that are within 5° of each other (13 pairs).
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.io import loadmat

from experiments.data.shape import Shape, read_shape
from experiments.framework.absence import DataAbsentError, require
from symjax.errors import FileFormatError
from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import suppress
from symjax.io import parsing

INSTRUCTIONS = """PRS-Net's planes for 1 000 models of ShapeNetCore.v2.
Get 1000.txt and gt_planes.mat (in evaluation.zip) from https://github.com/IGLICT/PRS-Net, the models from
https://shapenet.org (an account is needed), and lay them out as
  FOLDER/1000.txt
  FOLDER/gt_planes.mat
  FOLDER/ShapeNetCore.v2/SYNSET/MODEL/models/model_normalized.obj, or FOLDER/objs/MODEL.obj
(The OBJ files in the repository of E3Sym are in another frame, in which these planes are wrong.)"""

LIST, PLANES = "1000.txt", "gt_planes.mat"

APART = 5.0
"""Angle in degrees within which two planes count as one."""


def load(folder: Path) -> Iterator[Shape]:
    """Loads the listed models with their planes, in the order of the list.

    Args:
        folder: a folder with the layout of `INSTRUCTIONS`.

    Raises:
        DataAbsentError: if a file or a model does not exist.
        FileFormatError: if the list and the planes differ in length, or if a file is malformed.
    """
    names = _read_list(require(folder / LIST, INSTRUCTIONS))
    planes = read_planes(require(folder / PLANES, INSTRUCTIONS))
    if len(names) != len(planes):
        raise FileFormatError(f"{folder}: {LIST} lists {len(names)} models, {PLANES} has planes for {len(planes)}")
    models = [_model(folder, name) for name in names]
    missing = [name for name, path in zip(names, models, strict=True) if path is None]
    if missing:
        absent = f"no file of {len(missing)} of {len(names)} models in {folder}, the first of them {missing[0]}"
        raise DataAbsentError(f"DATA IS ABSENT: {absent}\n{INSTRUCTIONS}")
    rows = zip(names, models, planes, strict=True)
    return (read_shape(path, name, "ShapeNet, PRS-Net's planes", own) for name, path, own in rows if path)


def read_planes(path: Path) -> list[tuple[Plane, ...]]:
    """Reads the planes of every model.

    Raises:
        FileFormatError: if there is no cell array `gt_planes` or a cell holds no plane; the message names the file and
            the row.
    """
    try:
        cells = loadmat(path)["gt_planes"]
    except OSError:
        raise
    # SciPy raises errors of many types for a damaged file
    except Exception as error:
        raise FileFormatError(f"{path}: not a MAT file (before version 7.3) with a variable 'gt_planes'") from error
    if cells.dtype != object or cells.ndim != 2:
        raise FileFormatError(f"{path}: 'gt_planes' is not a cell array with one row per model")
    return [_planes_of(row, f"{path}, row {number} of 'gt_planes'") for number, row in enumerate(cells, start=1)]


def _planes_of(row: np.ndarray, where: str) -> tuple[Plane, ...]:
    rows = np.empty((0, 4))
    for cell in row:
        values = np.ravel(cell)
        if values.size == 0:
            continue
        if values.size != 4 or values.dtype.kind not in "fiu" or not np.isfinite(values).all():
            got = parsing.shown(str(values))
            raise FileFormatError(f"{where}: expected the four finite numbers of a plane, got {got}")
        length = float(np.linalg.norm(values[:3]))
        if length > 0:
            rows = np.vstack([rows, values / length])
    planes = Plane(rows[:, :3], -rows[:, 3])
    kept = suppress(planes, np.arange(len(rows)), angle=APART, offset=np.inf, most=len(rows))
    return tuple(Plane(planes.normal[k], planes.offset[k]) for k in kept)


def _read_list(path: Path) -> list[str]:
    names = []
    for number, line in enumerate(parsing.lines(path.read_bytes()), start=1):
        cells = line.split()
        if cells and (len(cells) > 2 or not cells[0].isalnum()):
            raise FileFormatError(
                f"{path}, line {number}: expected a model and the numbers of its planes, got {parsing.shown(line)}"
            )
        names += cells[:1]
    return names


def _model(folder: Path, name: str) -> Path | None:
    """Finds the file of a model, or None; a model that is in several categories is the same in each."""
    flat = folder / "objs" / f"{name}.obj"
    if flat.is_file():
        return flat
    return next(iter(sorted(folder.glob(f"ShapeNetCore.v2/*/{name}/models/model_normalized.obj"))), None)
