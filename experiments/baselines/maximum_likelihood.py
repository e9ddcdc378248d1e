"""The maximum-likelihood plane of mirror pairs, the paper's baseline (Sec. 3, "A Remark on MLE").

On the very pairs of our Sym-HKS. The paper's matrix H = Σ x yᵀ is right only where the pairs' mid-points have mean
zero, and it names no origin: the cloud's mean here, which is near theirs on complete clouds and not on others.
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
    """The plane of least squared residuals of the pairs, by minus their root mean square in mean radii.

    Attributes:
        as_printed: take the paper's H instead of the corrected one.
    """

    name: ClassVar[str] = "mle"

    as_printed: bool = False

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks the plane alone, see `Baseline.rank`; draws nothing.

        Raises:
            SymjaxError: there is no surface to take pairs from; the subclass says why.
        """
        frame, x, y = matches(points, rng)
        normal, offset = least_squares(x, y, as_printed=self.as_printed)
        residual = np.sqrt(((y - reflect(normal, offset, x)) ** 2).sum(axis=1).mean())
        return frame.ranking(normal[None], np.array([offset]), -np.array([residual]))
