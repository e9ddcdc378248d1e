"""Loads the SHREC 2023 track "Symmetry detection on point clouds": generated clouds with their mirror planes.

A file pointsID_sym.txt accompanies every cloud pointsID.txt. Its first line is the number of planes. Every further line
has six numbers, the normal and a point of one plane. The format follows the organisers' README and viewer
(ivansipiran/shrec2023-symmetry-detection).
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from experiments.data.numberfile import NumberFile
from experiments.data.shape import Shape, read_shape, through
from experiments.framework.absence import DataAbsentError, require
from symjax.geometry.plane import Plane

INSTRUCTIONS = """SHREC 2023: symmetry detection on point clouds, the training set, or the test set with its planes.
Get it through https://github.com/ivansipiran/shrec2023-symmetry-detection, and lay it out as
  FOLDER/pointsID.txt      a cloud, one point per line
  FOLDER/pointsID_sym.txt  its planes: their number, then one line per plane, normal and point
The test set was published without planes; without them results cannot be scored."""


def load(folder: Path) -> Iterator[Shape]:
    """Loads all clouds of a folder with their planes, in the order of their numbers.

    Raises:
        DataAbsentError: if the folder does not exist or holds no cloud, or if a cloud has no file of planes.
        FileFormatError: if a file is malformed.
    """
    clouds = {path.stem.removeprefix("points"): path for path in require(folder, INSTRUCTIONS).glob("points*.txt")}
    numbers = sorted((name for name in clouds if name.isdecimal()), key=int)
    if not numbers:
        raise DataAbsentError(f"DATA IS ABSENT: no points*.txt in {folder}\n{INSTRUCTIONS}")
    planes = {name: require(folder / f"points{name}_sym.txt", INSTRUCTIONS) for name in numbers}
    return (read_shape(clouds[name], f"points{name}", "SHREC 2023", read_planes(planes[name])) for name in numbers)


def read_planes(path: Path) -> list[Plane]:
    """Reads the planes of a cloud.

    Raises:
        FileFormatError: if the file is malformed; the message names the file and the line.
    """
    file = NumberFile(path)
    planes = []
    for _ in range(file.count("the number of planes")):
        normal, point = np.split(file.row(6, "normal and point of a plane"), 2)
        if not normal.any():
            raise file.error("the normal is zero")
        planes.append(through(normal, point))
    file.finish()
    return planes
