"""Putative mirror pairs for baselines: those of `SymHKS` (paper, Sec. 4), so that only the estimators differ."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.baselines.frame import Frame, make_frame
from symjax.preprocess.cloud import prepare
from symjax.symhks.correspondences import correspondences


class Matches(NamedTuple):
    """Putative mirror pairs of a cloud.

    Attributes:
        frame: frame of the points that were matched.
        x: one end of every pair, in the frame.
        y: the other end.
    """

    frame: Frame
    x: Float[np.ndarray, "q 3"]
    y: Float[np.ndarray, "q 3"]


def matches(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Matches:
    """Returns the pairs that `symjax.detect(points, "sym-hks")` fits its plane to.

    Args:
        points: the cloud.
        rng: random generator of the frame; unused, because the frame keeps all points.

    Raises:
        SymjaxError: if the cloud has too few points or no surface; a subclass names the reason.
    """
    cloud = prepare(points)
    used = points[cloud.rows]
    frame = make_frame(used, rng, max_points=len(used))
    x, y = frame.points[correspondences(cloud.points).rows.T]
    return Matches(frame, x, y)
