"""Principal planes: the planes through the mean, perpendicular to the principal axes, ranked by their symmetry.

The best of them is the start of B. Combès et al., *Automatic symmetry plane estimation of bilateral objects in point
clouds*, CVPR 2008. The normal of a mirror plane is a principal axis of a complete cloud; if two moments are equal, the
axes are not unique. The paper does not print how its row "PCA" chooses among the three planes.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import make_frame, reflect
from experiments.metrics.ranking import Ranking


@dataclass(frozen=True, kw_only=True)
class PCA(Baseline):
    """The three principal planes; the score is minus the mean distance of mirror images from the cloud, in mean radii.

    Attributes:
        max_points: number of points to which a larger cloud is thinned at random.
    """

    name: ClassVar[str] = "pca"

    max_points: int = 5000

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = make_frame(points, rng, max_points=self.max_points)
        tree = KDTree(frame.points)
        centre = frame.points.mean(axis=0)
        axes = principal_axes(frame.points)
        offsets = axes @ centre
        planes = zip(axes, offsets, strict=True)
        scores = -np.array([mean_residual(tree, normal, offset) for normal, offset in planes])
        return frame.ranking(axes, offsets, scores)


def principal_axes(points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3 3"]:
    """Returns the unit eigenvectors of the covariance as rows, by rising variance."""
    return np.linalg.eigh(np.cov(points, rowvar=False))[1].T


def mean_residual(tree: KDTree, normal: Float[np.ndarray, " 3"], offset: float) -> float:
    """Returns the mean distance of the mirror images of a cloud from the cloud."""
    return float(tree.query(reflect(normal, offset, tree.data))[0].mean())
