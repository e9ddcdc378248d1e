"""The frame in which planes are compared as 4-vectors (n, w): their offsets depend on origin and unit.

PRS-Net's is that of ShapeNetCore.v2: middle at the origin, bounding box of diagonal 1.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data.cases import Case
from experiments.metrics.prediction import Vectors


class Frame(NamedTuple):
    """Origin, and unit of length."""

    origin: Float[np.ndarray, "3"]
    length: float

    def of(self, planes: Vectors) -> Vectors:
        """Normals and offsets of planes in this frame."""
        normals, offsets = planes
        return normals, (offsets - normals @ self.origin) / self.length


AS_STORED = Frame(np.zeros(3), 1.0)
"""For planes that are in ShapeNetCore.v2's own frame already."""


def frame_of(case: Case) -> Frame:
    """About the mean of the points, in diagonals.

    Our choice for clouds in any pose: the middle of the bounding box, which is ShapeNet's, moves as the object turns.
    """
    return Frame(case.points.mean(axis=0), case.diagonal)
