"""The best principal plane: of the three through the mean and across a principal axis, the one that mirrors best.

The start of B. Combès et al., *Automatic symmetry plane estimation of bilateral objects in point clouds*, CVPR 2008. A
mirror plane's normal is a principal axis of a complete cloud, but not a unique one where two moments are equal. How the
paper's row "PCA" chooses among the three is not printed.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import framed, reflect
from experiments.metrics.ranking import Ranking


@dataclass(frozen=True, kw_only=True)
class PCA(Baseline):
    """The three principal planes, by minus the mean distance of mirror images from the cloud, in mean radii.

    Attributes:
        most: points that are kept of a larger cloud, drawn at random.
    """

    name: ClassVar[str] = "pca"

    most: int = 5000

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = framed(points, rng, most=self.most)
        tree = KDTree(frame.points)
        centre = frame.points.mean(axis=0)
        axes = principal_axes(frame.points)
        offsets = axes @ centre
        planes = zip(axes, offsets, strict=True)
        scores = -np.array([mean_residual(tree, normal, offset) for normal, offset in planes])
        return frame.ranking(axes, offsets, scores)


def principal_axes(points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3 3"]:
    """Unit eigenvectors of the covariance, one a row, of rising variance."""
    return np.linalg.eigh(np.cov(points, rowvar=False))[1].T


def mean_residual(tree: KDTree, normal: Float[np.ndarray, " 3"], offset: float) -> float:
    """Mean distance of the mirror images of a cloud from the cloud."""
    return float(tree.query(reflect(normal, offset, tree.data))[0].mean())
