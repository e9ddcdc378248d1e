"""Loads the 3D part of the ICCV 2017 challenge (Funk et al. 2017): 1 354 synthetic objects, and 20 real scans.

A text file NAME-plane.txt accompanies every model NAME.ply. Its first line is the number of planes. Every plane has
four lines: three corners of a rectangle, and the extent of the object along the normal. The format and the file names
follow the organisers' code (3DsymChallengeICCV17: `createscene.cpp`, `table-plane.txt`) and a reader of the training
set (`symcomp17_dataset.py`), which adds no second hyphen to a name that ends in one. That the test set and the real
scans have the same layout is from memory, not checked.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float

from experiments.data.numberfile import NumberFile
from experiments.data.shape import Shape, read_shape, through
from experiments.framework.absence import DataAbsentError, require
from symjax.errors import FileFormatError
from symjax.io.points import MESHES

INSTRUCTIONS = """Funk et al., "2017 ICCV challenge: detecting symmetry in the wild": 3D global symmetry.
Get it from https://sites.google.com/view/symcomp17/ or its organisers, and lay it out as
  FOLDER/NAME.ply        one model
  FOLDER/NAME-plane.txt  its planes: their number, then three corners and one extent per plane"""

ENDING = "plane.txt"

SUFFIXES = (*MESHES, ".pcd", ".xyz")
"""File name extensions of models; .txt is not one of them, because the folder has other text files."""

FLAT = 1e-9
"""Three corners are collinear if the sine of the angle at the first one is below this."""


def load(folder: Path) -> Iterator[Shape]:
    """Loads all models of a folder with their planes, in the order of their names.

    Raises:
        DataAbsentError: if the folder does not exist or holds no file of planes.
        FileFormatError: if a model has no file of planes or vice versa, or if a file is malformed.
    """
    pairs = _pairs(require(folder, INSTRUCTIONS))
    return (_shape(name, model, planes) for name, (model, planes) in pairs.items())


def read_corners(path: Path) -> Float[np.ndarray, "k 3 3"]:
    """Reads three corners of every plane's rectangle; `metrics.patch.from_corners` turns them into rectangles.

    Raises:
        FileFormatError: if the file is malformed; the message names the file and the line.
    """
    file = NumberFile(path)
    corners = []
    for _ in range(file.count("the number of planes")):
        a, b, c = (file.row(3, "a corner of a plane") for _ in range(3))
        if np.linalg.norm(np.cross(b - a, c - a)) <= FLAT * np.linalg.norm(b - a) * np.linalg.norm(c - a):
            raise file.error("the three corners that end on this line are collinear")
        corners.append([a, b, c])
        file.row(1, "the extent along the normal")
    file.finish()
    return np.array(corners).reshape(-1, 3, 3)


def _pairs(folder: Path) -> dict[str, tuple[Path, Path]]:
    """Returns the model file and the file of planes of every model, by name."""
    planes = {path.name.removesuffix(ENDING): path for path in folder.glob(f"*-{ENDING}")}
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    models = {path.name.removesuffix(path.suffix): path for path in files}
    if len(models) < len(files):
        raise FileFormatError(f"{folder}: {len(files)} model files share {len(models)} names: keep one file per name")
    if not planes:
        raise DataAbsentError(f"DATA IS ABSENT: no *-{ENDING} in {folder}\n{INSTRUCTIONS}")
    of_model = {name: name if name.endswith("-") else f"{name}-" for name in models}
    without = sorted(name for name, stem in of_model.items() if stem not in planes)
    unused = sorted(set(planes) - set(of_model.values()))
    if without or unused:
        first = f"model {without[0]!r} has no file of planes" if without else f"{planes[unused[0]].name!r} has no model"
        counts = f"{len(without)} models have no file of planes, {len(unused)} files of planes have no model"
        raise FileFormatError(f"{folder}: {counts}; for example, {first}")
    return {name: (models[name], planes[of_model[name]]) for name in sorted(models)}


def _shape(name: str, model: Path, planes: Path) -> Shape:
    corners = read_corners(planes)
    shape = read_shape(model, name, "Funk 2017", (through(np.cross(b - a, c - a), a) for a, b, c in corners))
    return shape._replace(corners=corners)
