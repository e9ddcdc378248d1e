"""Mirror pairs for baselines: those of our Sym-HKS (Sec. 4 of the paper), so that only estimators differ."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.baselines.frame import Frame, framed
from symjax.preprocess.cloud import prepare
from symjax.symhks.correspondences import correspondences


class Matches(NamedTuple):
    """Putative mirror pairs of a cloud.

    Attributes:
        frame: of the points that were looked at.
        x: one end of every pair, in the frame.
        y: the other end.
    """

    frame: Frame
    x: Float[np.ndarray, "q 3"]
    y: Float[np.ndarray, "q 3"]


def matches(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Matches:
    """The pairs that `symjax.detect(points, "sym-hks")` fits its plane to.

    Args:
        points: the cloud.
        rng: of the frame, which keeps all points and draws nothing.

    Raises:
        SymjaxError: there is no surface to take pairs from; the subclass says why.
    """
    cloud = prepare(points)
    used = points[cloud.rows]
    frame = framed(used, rng, most=len(used))
    x, y = frame.points[correspondences(cloud.points).rows.T]
    return Matches(frame, x, y)
