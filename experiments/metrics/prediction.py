"""The input of every metric: the planes that a method predicts for a case."""

from typing import NamedTuple

import numpy as np

from experiments.data.cases import Case
from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity


class Prediction(NamedTuple):
    """A case and the planes predicted for it.

    Attributes:
        ranking: predicted planes, best first; empty if the method failed.
        case: the whole object, with its points and true planes in one frame.
    """

    ranking: Ranking
    case: Case

    @property
    def answers(self) -> Plane:
        """The predicted planes, best first."""
        return Plane(self.ranking.normals, self.ranking.offsets)

    @property
    def truths(self) -> Plane:
        """The true planes; those through an axis, which are infinitely many, are not included."""
        planes = self.case.planes
        return Plane(np.array([p.normal for p in planes]).reshape(-1, 3), np.array([float(p.offset) for p in planes]))

    @property
    def to_diagonals(self) -> Similarity:
        """Transform to the frame in which planes are compared as 4-vectors: origin at the mean, unit of one diagonal.

        The offsets depend on the origin and the unit. PRS-Net uses the frame of ShapeNetCore.v2, whose origin is the
        centre of a bounding box of diagonal 1. For clouds in any pose we use the mean instead: the centre of the
        bounding box moves as the object rotates.
        """
        return Similarity(self.case.diagonal, None, self.case.points.mean(axis=0)).inverse()
