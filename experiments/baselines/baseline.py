"""The base class of baselines, which turns a ranking of planes into a method of `symjax.detect`.

To add a baseline, write a module beside this one with a frozen dataclass of its parameters:

    @dataclass(frozen=True, kw_only=True)
    class Centroid(Baseline):
        # the plane x = 0 through the mean of the cloud, with a constant score
        name: ClassVar[str] = "centroid"

        max_points: int = 5000

        def rank(self, points, rng):
            frame = make_frame(points, rng, max_points=self.max_points)
            return frame.ranking(np.array([[1.0, 0.0, 0.0]]), np.array([0.0]), np.array([1.0]))

The docstring of the module names the publication and says which parts are the authors' and which are ours. Then add a
line to `ENTRIES` in `experiments.baselines.registry`: the baseline takes part in the comparisons, and
`tests/experiments/baselines/test_baseline.py` checks it. `symjax.detect(points, method=Centroid())` works as well.

`experiments.baselines.pca` is the shortest example. A method that finds its mirror planes by itself, and reports more
than a ranking, implements `symjax.Method` instead.
"""

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
    """A `symjax.Method` that accepts its best plane in every cloud; subclasses are frozen dataclasses of parameters.

    Attributes:
        name: name of the method.
        drops_outliers: False: the method sees all points, outliers included.
        accepts_all: whether the method ranks only planes that its own rule accepts as mirror planes. If False, only the
            best of its planes is a mirror plane.
    """

    name: ClassVar[str]
    drops_outliers: ClassVar[bool] = False
    accepts_all: ClassVar[bool] = False

    @abstractmethod
    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud.

        Args:
            points: the cloud, in any units and any pose, neither thinned nor cleaned.
            rng: random generator; the ranking depends on nothing else.

        Returns:
            The planes with their scores, best first, in the units of the points (`Frame.ranking` makes one). Distinct
            planes, at least one, with unit normals.
        """

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud, see `symjax.Method.find`; keeps all ranked planes as candidates."""
        with timer.stage("searching"):
            ranking = self.rank(given_points(cloud), rng)
        to_cloud = cloud.to_given.inverse()
        planes = [to_cloud.plane(Plane(*plane)) for plane in zip(ranking.normals, ranking.offsets, strict=True)]
        scores = ranking.scores.tolist()
        accepted = tuple(planes if self.accepts_all else planes[:1])
        candidates = (Candidate(plane, score, score) for plane, score in zip(planes, scores, strict=True))
        symmetry: Symmetry = "several planes" if len(accepted) > 1 else "one plane" if accepted else "none"
        return MethodResult(tuple(candidates), accepted, symmetry)


def given_points(cloud: Cloud) -> Float[np.ndarray, "n 3"]:
    """Returns the points of a cloud in the pose and the order in which the user passed them.

    A baseline must not see the cloud frame: there the mirror plane's normal is often along an axis, which favours
    methods that use a grid or fixed directions.
    """
    return np.asarray(cloud.to_given.points(cloud.points))[np.argsort(cloud.rows)]
