"""Loads the 21 objects of YCB-Video, with planes annotated by Wu et al. (arXiv 2003.06520).

`symmetries.txt` has five lines per object, in the order of YCB-Video: a point, the normals of three mirror planes
through it, and one direction. A line 0 0 0 means that there is no such plane or direction. The file, and code that
reads it (`mirror`, `center`), are in the authors' repository. That the direction is the axis of a solid of revolution
is our conclusion from the file: the cans, the bowl and the marker have one. The source of the models and their file
names are from memory, not checked.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data.numberfile import NumberFile
from experiments.data.shape import Shape, read_shape, through
from experiments.framework.absence import DataAbsentError, require
from symjax.geometry.plane import Plane
from symjax.method.result import Axis

INSTRUCTIONS = """YCB-Video models with annotated planes.
Get the models from https://rse-lab.cs.washington.edu/projects/posecnn/ (YCB-Video 3D models), symmetries.txt from
https://github.com/Allen--Wu/Symmetry-Detection-of-Occluded-Point-Cloud-Using-Deep-Learning, and lay them out as
  FOLDER/symmetries.txt
  FOLDER/models/002_master_chef_can/textured.obj, or textured_simple.obj, or points.xyz, and so on for all 21"""

NAMES = (
    *("002_master_chef_can", "003_cracker_box", "004_sugar_box", "005_tomato_soup_can", "006_mustard_bottle"),
    *("007_tuna_fish_can", "008_pudding_box", "009_gelatin_box", "010_potted_meat_can", "011_banana"),
    *("019_pitcher_base", "021_bleach_cleanser", "024_bowl", "025_mug", "035_power_drill", "036_wood_block"),
    *("037_scissors", "040_large_marker", "051_large_clamp", "052_extra_large_clamp", "061_foam_brick"),
)
"""Names of the objects, in the order of YCB-Video."""

FILES = ("textured.obj", "textured_simple.obj", "points.xyz")
"""File names of a model; the first that exists is read."""

UNIT_TOLERANCE = 0.01
"""Largest difference between the length of an annotated direction and 1."""


class Symmetries(NamedTuple):
    """The annotation of an object.

    Attributes:
        planes: mirror planes, with unit normals.
        axis: point on and direction of the axis of revolution, if there is one.
    """

    planes: tuple[Plane, ...]
    axis: Axis | None


def load(folder: Path) -> Iterator[Shape]:
    """Loads the 21 objects with their planes and axes.

    Raises:
        DataAbsentError: if the annotations or a model do not exist.
        FileFormatError: if a file is malformed.
    """
    annotated = read_symmetries(require(folder / "symmetries.txt", INSTRUCTIONS))
    models = [_model(folder / "models" / name) for name in NAMES]
    rows = zip(NAMES, models, annotated, strict=True)
    return (read_shape(model, name, "YCB", own.planes, own.axis) for name, model, own in rows)


def read_symmetries(path: Path) -> list[Symmetries]:
    """Reads the annotations of all objects.

    Raises:
        FileFormatError: if the file is malformed; the message names the file and the line.
    """
    file = NumberFile(path)
    objects = []
    for name in NAMES:
        centre = file.row(3, f"the point of {name}")
        mirrors = [_direction(file, f"a normal of {name}") for _ in range(3)]
        axis = _direction(file, f"the axis of {name}")
        planes = tuple(through(normal, centre) for normal in mirrors if normal is not None)
        objects.append(Symmetries(planes, None if axis is None else (centre, axis)))
    file.finish()
    return objects


def _direction(file: NumberFile, what: str) -> Float[np.ndarray, " 3"] | None:
    """Reads a direction and normalises it; returns None if it is annotated as 0 0 0."""
    vector = file.row(3, what)
    length = float(np.linalg.norm(vector))
    if length == 0:
        return None
    if abs(length - 1) > UNIT_TOLERANCE:
        raise file.error(f"expected a direction of length 1 or 0, got length {length:.3g}")
    return vector / length


def _model(folder: Path) -> Path:
    for name in FILES:
        if (folder / name).is_file():
            return folder / name
    raise DataAbsentError(f"DATA IS ABSENT: none of {', '.join(FILES)} in {folder}\n{INSTRUCTIONS}")
