"""The SHREC 2023 track "Symmetry detection on point clouds": clouds with the planes that they were made with.

Beside every cloud pointsID.txt is a file pointsID_sym.txt: the number of planes, then normal and a point of each, six
numbers a line, as the organisers' README and viewer have it (ivansipiran/shrec2023-symmetry-detection).
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from experiments.data.numberfile import NumberFile
from experiments.data.shape import Shape, read_shape, through
from experiments.framework.absence import DataAbsentError, required
from symjax.geometry.plane import Plane

INSTRUCTIONS = """SHREC 2023: symmetry detection on point clouds, the training set, or the test set with its planes.
Get it through https://github.com/ivansipiran/shrec2023-symmetry-detection, and lay it out as
  FOLDER/pointsID.txt      a cloud, one point a line
  FOLDER/pointsID_sym.txt  its planes: count, then normal and point a line
The test set was published without planes: there is nothing to score it with."""


def load(folder: Path) -> Iterator[Shape]:
    """All clouds of a folder with their planes, by rising number.

    Raises:
        DataAbsentError: there is no such folder, no cloud in it, or a cloud without planes.
        FileFormatError: a file is malformed.
    """
    clouds = {path.stem.removeprefix("points"): path for path in required(folder, INSTRUCTIONS).glob("points*.txt")}
    numbers = sorted((name for name in clouds if name.isdecimal()), key=int)
    if not numbers:
        raise DataAbsentError(f"DATA IS ABSENT: no points*.txt in {folder}\n{INSTRUCTIONS}")
    planes = {name: required(folder / f"points{name}_sym.txt", INSTRUCTIONS) for name in numbers}
    return (read_shape(clouds[name], f"points{name}", "SHREC 2023", read_planes(planes[name])) for name in numbers)


def read_planes(path: Path) -> list[Plane]:
    """The planes of a file.

    Raises:
        FileFormatError: it is malformed; file and line are named.
    """
    file = NumberFile(path)
    planes = []
    for _ in range(file.count("the number of planes")):
        normal, point = np.split(file.row(6, "normal and point of a plane"), 2)
        if not normal.any():
            raise file.fault("the normal is 0")
        planes.append(through(normal, point))
    file.finish()
    return planes
