"""What every metric scores: the planes that a method predicts, and the case that they are for."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.baselines.ranking import Ranking
from experiments.data.cases import Case

Vectors = tuple[Float[np.ndarray, "k 3"], Float[np.ndarray, "k"]]
"""Unit normals and offsets."""


class Prediction(NamedTuple):
    """A case and the planes predicted for it.

    Attributes:
        ranking: the predicted planes, best first; none where the method gave up.
        case: the object, whole: its points and right planes in one frame.
    """

    ranking: Ranking
    case: Case

    @property
    def answers(self) -> Vectors:
        """The predicted planes, best first."""
        return self.ranking.normals, self.ranking.offsets

    @property
    def truths(self) -> Vectors:
        """The right planes that are listed; the planes through an axis are not."""
        planes = self.case.planes
        return np.array([p.normal for p in planes]).reshape(-1, 3), np.array([float(p.offset) for p in planes])
