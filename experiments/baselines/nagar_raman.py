"""One-to-one matches with the mirror image and the least-squares plane in turn, after Nagar and Raman.

After R. Nagar and S. Raman, *Detecting Approximate Reflection Symmetry in a Point Set Using Optimization on Manifold*,
IEEE Transactions on Signal Processing 67(6), 2019. Theirs: every round assigns the points to their mirror images by
linear assignment and then moves the mirror. They move it by optimisation over rotations and translations, which for a
plane has the closed form that is used here. The starts are our choice, as in `three_d_symm`.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import framed
from experiments.baselines.pca import principal_axes
from experiments.baselines.three_d_symm import Match, ended
from experiments.metrics.ranking import Ranking


@dataclass(frozen=True, kw_only=True)
class NagarRaman(Baseline):
    """The distinct planes that the three principal ones end in.

    They are ranked by minus the root mean square distance of mirror images from their partners, in mean radii. A
    permutation leaves the mean of the mid-points where it is, so that every plane passes through the mean. Those of the
    points kept are about their own mean; the plane that is returned passes through the mean of all.

    Attributes:
        most: points that are kept of a larger cloud, drawn at random: the cost of a round grows with its cube.
        steps: most rounds from a start.
        tol: distance of two planes (see `plane_distance`) at which a start has converged.
    """

    name: ClassVar[str] = "nagar-raman"

    most: int = 500
    steps: int = 100
    tol: float = 1e-6

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = framed(points, rng, most=self.most)
        # the mean of a few points is several times as far from the plane as the mean of all
        frame = frame._replace(points=frame.points - frame.points.mean(axis=0))
        return ended(frame, principal_axes(frame.points), assigned(frame.points), steps=self.steps, tol=self.tol)


def assigned(points: Float[np.ndarray, "n 3"]) -> Match:
    """Matches mirror images with the points of a cloud one to one, at the least sum of squared distances."""
    return lambda image: points[linear_sum_assignment(cdist(image, points, "sqeuclidean"))[1]]
