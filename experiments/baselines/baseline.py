"""What all baselines have in common: they rank planes of the points as these were given."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane
from symjax.method.result import Candidate, MethodResult, Symmetry
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud


class Baseline(ABC):
    """A `symjax.Method` that never doubts its best plane; subclasses are frozen dataclasses of their parameters.

    Attributes:
        name: of the method.
        drops_outliers: False: nothing is left out before it.
        several: whether it lists only planes that its own rule accepts, which are all mirror planes then; otherwise the
            first alone is.
    """

    name: ClassVar[str]
    drops_outliers: ClassVar[bool] = False
    several: ClassVar[bool] = False

    @abstractmethod
    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud.

        Args:
            points: the cloud, in any units and anywhere.
            rng: generator of everything random.
        """

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud, see `symjax.Method.find`."""
        with timer.stage("searching"):
            ranking = self.rank(as_given(cloud), rng)
        to_cloud = cloud.to_given.inverse()
        planes = [to_cloud.plane(Plane(*plane)) for plane in zip(ranking.normals, ranking.offsets, strict=True)]
        scores = ranking.scores.tolist()
        held = tuple(planes if self.several else planes[:1])
        candidates = (Candidate(plane, score, score) for plane, score in zip(planes, scores, strict=True))
        symmetry: Symmetry = "several planes" if len(held) > 1 else "one plane" if held else "none"
        return MethodResult(tuple(candidates), held, symmetry)


def as_given(cloud: Cloud) -> Float[np.ndarray, "n 3"]:
    """The points of a cloud in the pose and the order in which they were given.

    The cloud's own frame has the mirror's normal along an axis more often than not, which methods that work on a grid,
    or from fixed directions, would profit from.
    """
    return np.asarray(cloud.to_given.points(cloud.points))[np.argsort(cloud.rows)]
