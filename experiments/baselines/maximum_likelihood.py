"""The maximum-likelihood plane of mirror pairs, the paper's baseline (Sec. 3, "A Remark on MLE").

On the very pairs of our Sym-HKS. The paper's matrix H = Σ x yᵀ is right only where the pairs' mid-points have mean
zero, and it names no origin: the cloud's mean here, which is near theirs on complete clouds and not on others.
"""

import numpy as np
from jaxtyping import Float

from experiments.baselines.least_squares import least_squares
from experiments.baselines.matches import matches
from experiments.baselines.ranking import Ranking, reflect


def find(
    points: Float[np.ndarray, "n 3"],
    *,
    rng: np.random.Generator,
    as_printed: bool = False,
    drop_outliers: bool = False,
) -> Ranking:
    """The plane of least squared residuals of the pairs.

    Args:
        points: the cloud.
        rng: draws nothing: pairs and plane are determined by the points.
        as_printed: take the paper's H instead of the corrected one.
        drop_outliers: leave out scattered outliers before pairs are made.

    Returns:
        One plane, by minus the root mean square residual of the pairs in mean radii.

    Raises:
        SymjaxError: there is no surface to take pairs from; the subclass says why.
    """
    frame, x, y = matches(points, rng, drop_outliers=drop_outliers)
    normal, offset = least_squares(x, y, as_printed=as_printed)
    residual = np.sqrt(((y - reflect(normal, offset, x)) ** 2).sum(axis=1).mean())
    return frame.ranking(normal[None], np.array([offset]), -np.array([residual]))
