"""The 3D part of the ICCV 2017 challenge (Funk et al. 2017): 1 354 synthetic objects, and 20 real scans.

Beside every model NAME.ply is a text file NAME-plane.txt: the number of planes, then for every plane three corners of
a rectangle, a line each, and the extent of the object along the normal. The format and the names are those of the
organisers' code (3DsymChallengeICCV17: `createscene.cpp`, `table-plane.txt`) and of a reader of the training set
(`symcomp17_dataset.py`), by which a name that ends in a hyphen gets no second one. That the test set and the real
scans are laid out alike is from memory.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Float

from experiments.data.numberfile import NumberFile
from experiments.data.shape import Shape, read_shape, through
from experiments.framework.absence import DataAbsentError, required
from symjax.errors import FileFormatError
from symjax.io.points import MESHES

INSTRUCTIONS = """Funk et al., "2017 ICCV challenge: detecting symmetry in the wild": 3D global symmetry.
Get it from https://sites.google.com/view/symcomp17/ or its organisers, and lay it out as
  FOLDER/NAME.ply        one model
  FOLDER/NAME-plane.txt  its planes: count, then three corners and one extent a plane"""

ENDING = "plane.txt"

SUFFIXES = (*MESHES, ".pcd", ".xyz")
"""Of models: other text files may lie beside them."""

FLAT = 1e-9
"""Twice the area of three corners over the product of their distances, below which they are on one line."""


def load(folder: Path) -> Iterator[Shape]:
    """All models of a folder with their planes, by name.

    Raises:
        DataAbsentError: there is no such folder, or no file of planes in it.
        FileFormatError: a model has no planes, planes have no model, or a file is malformed.
    """
    pairs = _pairs(required(folder, INSTRUCTIONS))
    return (_shape(name, model, planes) for name, (model, planes) in pairs.items())


def read_corners(path: Path) -> Float[np.ndarray, "k 3 3"]:
    """The corners p_a, p_b and p_c of every plane; `metrics.patch.from_corners` makes rectangles of them.

    Raises:
        FileFormatError: it is malformed; file and line are named.
    """
    file = NumberFile(path)
    corners = []
    for _ in range(file.count("the number of planes")):
        a, b, c = three = [file.row(3, "a corner of a plane") for _ in range(3)]
        if np.linalg.norm(np.cross(b - a, c - a)) <= FLAT * np.linalg.norm(b - a) * np.linalg.norm(c - a):
            raise file.fault("the three corners that end here are on one line")
        corners.append(three)
        file.row(1, "the extent along the normal")
    file.finish()
    return np.array(corners).reshape(-1, 3, 3)


def _pairs(folder: Path) -> dict[str, tuple[Path, Path]]:
    """Model and planes by name."""
    planes = {path.name.removesuffix(ENDING): path for path in folder.glob(f"*-{ENDING}")}
    files = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    models = {path.name.removesuffix(path.suffix): path for path in files}
    if len(models) < len(files):
        raise FileFormatError(f"{folder}: {len(files)} model files, and only {len(models)} names: one of each expected")
    if not planes:
        raise DataAbsentError(f"DATA IS ABSENT: no *-{ENDING} in {folder}\n{INSTRUCTIONS}")
    of_model = {name: name if name.endswith("-") else f"{name}-" for name in models}
    without = sorted(name for name, stem in of_model.items() if stem not in planes)
    unused = sorted(set(planes) - set(of_model.values()))
    if without or unused:
        first = f"{without[0]!r} has no planes" if without else f"{planes[unused[0]].name!r} has no model"
        raise FileFormatError(f"{folder}: {len(without)} models without planes, {len(unused)} the reverse: {first}")
    return {name: (models[name], planes[of_model[name]]) for name in sorted(models)}


def _shape(name: str, model: Path, planes: Path) -> Shape:
    corners = read_corners(planes)
    shape = read_shape(model, name, "Funk 2017", (through(np.cross(b - a, c - a), a) for a, b, c in corners))
    return shape._replace(corners=corners)
