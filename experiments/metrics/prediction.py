"""What every metric scores: the planes that a method predicts, and the case that they are for."""

from typing import NamedTuple

import numpy as np

from experiments.data.cases import Case
from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity


class Prediction(NamedTuple):
    """A case and the planes predicted for it.

    Attributes:
        ranking: the predicted planes, best first; none where the method gave up.
        case: the object, whole: its points and right planes in one frame.
    """

    ranking: Ranking
    case: Case

    @property
    def answers(self) -> Plane:
        """The predicted planes, best first."""
        return Plane(self.ranking.normals, self.ranking.offsets)

    @property
    def truths(self) -> Plane:
        """The right planes that are listed; the planes through an axis are not."""
        planes = self.case.planes
        return Plane(np.array([p.normal for p in planes]).reshape(-1, 3), np.array([float(p.offset) for p in planes]))

    @property
    def to_diagonals(self) -> Similarity:
        """Into the frame in which planes are compared as 4-vectors: about the mean of the points, in diagonals.

        Their offsets depend on origin and unit. PRS-Net's frame is that of ShapeNetCore.v2: the middle of the bounding
        box, of diagonal 1. The mean is our choice for clouds in any pose: that middle moves as the object turns.
        """
        return Similarity(self.case.diagonal, None, self.case.points.mean(axis=0)).inverse()
