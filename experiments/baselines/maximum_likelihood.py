"""The maximum-likelihood plane of mirror pairs, the paper's baseline (Sec. 3, "A Remark on MLE").

The pairs are those of `SymHKS`. The paper's matrix H = Σ x yᵀ is correct only if the mid-points of the pairs have mean
zero, and the paper names no origin. Here the origin is the mean of the cloud, which is near the mean of the mid-points
on complete clouds, but not on others.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import reflect
from experiments.baselines.least_squares import least_squares
from experiments.baselines.matches import matches
from experiments.metrics.ranking import Ranking


@dataclass(frozen=True, kw_only=True)
class MaximumLikelihood(Baseline):
    """The least-squares plane of the pairs; its score is minus the root mean square residual, in mean radii.

    Attributes:
        as_printed: use the paper's H instead of the corrected matrix.
    """

    name: ClassVar[str] = "mle"

    as_printed: bool = False

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks a single plane, see `Baseline.rank`; `rng` is unused.

        Raises:
            SymjaxError: if the cloud has too few points or no surface; a subclass names the reason.
        """
        frame, x, y = matches(points, rng)
        normal, offset = least_squares(x, y, as_printed=self.as_printed)
        residual = np.sqrt(((y - reflect(normal, offset, x)) ** 2).sum(axis=1).mean())
        return frame.ranking(normal[None], np.array([offset]), -np.array([residual]))
