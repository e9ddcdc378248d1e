"""RANSAC over mirror pairs: one pair makes a plane, the others vote.

M. A. Fischler and R. C. Bolles, *Random sample consensus*, Communications of the ACM 24(6), 1981, with the truncated
squares of P. H. S. Torr and A. Zisserman, *MLESAC*, CVIU 78, 2000, on the very pairs of our Sym-HKS. The paper's row
"RANSAC" gives neither pairs nor parameters: all values here are our choice.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import reflect
from experiments.baselines.least_squares import least_squares
from experiments.baselines.matches import matches
from experiments.metrics.ranking import Ranking, distinct

THRESHOLD = 0.15
"""Residual of an inlier in mean radii. Keypoints are 0.05 to 0.1 apart, so that 0.02 to 0.05, which suits dense
matches, leaves few: of generated clouds, 86 % were within 5 degrees with 0.05 and 95 % with 0.15."""

APART = 0.1
"""Planes nearer than this (see `plane_distance`) are one."""

MIN_INLIERS = 3
"""Fewer pairs do not fix a plane against one outlier."""


@dataclass(frozen=True, kw_only=True)
class RansacOnMatches(Baseline):
    """The planes that most pairs of a cloud agree with.

    Distinct planes by 1 − mean of min(ρ², τ²)/τ², with ρ the residual of a pair and τ the threshold.

    Attributes:
        draws: most pairs drawn, none twice.
        threshold: residual of an inlier, in mean radii.
        shortest: share of the pairs, the shortest, that make no planes: their directions are the least certain.
        refits: least-squares fits to the inliers that follow.
        most: planes that are kept.
    """

    name: ClassVar[str] = "ransac-matches"
    several: ClassVar[bool] = True

    draws: int = 500
    threshold: float = THRESHOLD
    shortest: float = 0.3
    refits: int = 2
    most: int = 3

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`; draws the pairs that make planes.

        Raises:
            SymjaxError: there is no surface to take pairs from; the subclass says why.
        """
        frame, x, y = matches(points, rng)
        return frame.ranking(*self.consensus(x, y, rng))

    def consensus(
        self, x: Float[np.ndarray, "q 3"], y: Float[np.ndarray, "q 3"], rng: np.random.Generator
    ) -> tuple[Float[np.ndarray, "k 3"], Float[np.ndarray, " k"], Float[np.ndarray, " k"]]:
        """The planes that most pairs agree with: normals, offsets and scores."""
        step = y - x
        length = np.linalg.norm(step, axis=1)
        longest = np.argsort(-length, kind="stable")[: len(x) - int(self.shortest * len(x))]
        drawn = longest[rng.permutation(len(longest))[: self.draws]]
        normals = step[drawn] / length[drawn, None]
        offsets = (normals * (x + y)[drawn] / 2).sum(axis=1)
        scores = agreement(normals, offsets, x, y, self.threshold)
        best = distinct(normals, offsets, scores, apart=APART, most=self.most)
        planes = [refit(normals[k], offsets[k], x, y, self.threshold, self.refits) for k in best]
        normals, offsets = (np.array(part) for part in zip(*planes, strict=True))
        scores = agreement(normals, offsets, x, y, self.threshold)
        # two planes may have been fitted to the same pairs
        best = distinct(normals, offsets, scores, apart=APART, most=self.most)
        return normals[best], offsets[best], scores[best]


def agreement(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    x: Float[np.ndarray, "q 3"],
    y: Float[np.ndarray, "q 3"],
    threshold: float,
) -> Float[np.ndarray, " k"]:
    """1 − mean of min(ρ², τ²)/τ² over the pairs: 1 where all fit exactly, 0 where none is an inlier."""
    residuals = np.array([residual(*plane, x, y) for plane in zip(normals, offsets, strict=True)])
    return 1 - np.minimum((residuals / threshold) ** 2, 1).mean(axis=1)


def refit(
    normal: Float[np.ndarray, " 3"],
    offset: float,
    x: Float[np.ndarray, "q 3"],
    y: Float[np.ndarray, "q 3"],
    threshold: float,
    times: int,
) -> tuple[Float[np.ndarray, " 3"], float]:
    """The plane of least squares of a plane's inliers, so many times; the plane as it is where they are too few."""
    for _ in range(times):
        inlier = residual(normal, offset, x, y) < threshold
        if np.count_nonzero(inlier) < MIN_INLIERS:
            break
        normal, offset = least_squares(x[inlier], y[inlier])
    return normal, offset


def residual(
    normal: Float[np.ndarray, " 3"], offset: float, x: Float[np.ndarray, "q 3"], y: Float[np.ndarray, "q 3"]
) -> Float[np.ndarray, " q"]:
    """Distance of y from the mirror image of x."""
    return np.linalg.norm(y - reflect(normal, offset, x), axis=1)
