"""Alternation of one-to-one matching and least squares, after Nagar and Raman.

After R. Nagar and S. Raman, *Detecting Approximate Reflection Symmetry in a Point Set Using Optimization on Manifold*,
IEEE Transactions on Signal Processing 67(6), 2019. As published: every step matches mirror images with points by linear
assignment, and then improves the plane. The authors improve it by optimisation over rotations and translations; for a
plane this has a closed form, which is used here. Ours: the starts, as in `three_d_symm`.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import make_frame
from experiments.baselines.pca import principal_axes
from experiments.baselines.three_d_symm import Match, alternate_from
from experiments.metrics.ranking import Ranking


@dataclass(frozen=True, kw_only=True)
class NagarRaman(Baseline):
    """The distinct planes that the alternation converges to from the three principal planes.

    The score is minus the root mean square distance of mirror images from their matches, in mean radii. Because matches
    are a permutation of the points, the mean of the mid-points is the mean of the points, and every fitted plane passes
    through it. The returned planes pass through the mean of all points, not through that of the points that were kept.

    Attributes:
        max_points: number of points to which a larger cloud is thinned at random; a step costs its cube.
        max_steps: limit on the steps from one start.
        tol: convergence tolerance: distance of the planes of two successive steps (`plane_distance`).
    """

    name: ClassVar[str] = "nagar-raman"

    max_points: int = 500
    max_steps: int = 100
    tol: float = 1e-6

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = make_frame(points, rng, max_points=self.max_points)
        # planes are fitted about the mean of the kept points and moved to the mean of all points, which is several
        # times nearer to the true plane
        frame = frame._replace(points=frame.points - frame.points.mean(axis=0))
        match = assignment(frame.points)
        return alternate_from(principal_axes(frame.points), frame, match, max_steps=self.max_steps, tol=self.tol)


def assignment(points: Float[np.ndarray, "n 3"]) -> Match:
    """Returns a function that matches mirror images one to one with points, by the least sum of squared distances."""
    return lambda image: points[linear_sum_assignment(cdist(image, points, "sqeuclidean"))[1]]
