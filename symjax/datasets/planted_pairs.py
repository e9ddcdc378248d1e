"""Pairs with a planted mirror plane: what the estimator is measured on. NumPy only."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from symjax.errors import InvalidArgumentError

NOISE = 0.01
# semi-axes of the blob along the mirror's normal and along two directions in the mirror
SEMI_AXES = {"isotropic": (1.0, 1.0, 1.0), "thin": (0.4, 0.7, 1.0), "wide": (1.0, 0.7, 0.4)}


class PlantedPairs(NamedTuple):
    """Pairs of points with a known mirror plane.

    Attributes:
        x: one end of every pair.
        y: the other end.
        normal: unit normal of the planted plane.
        offset: its offset, normal · x = offset.
        inlier: which pairs are mirror pairs.
    """

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, " 3"]
    offset: float
    inlier: Bool[np.ndarray, " n"]


def _in_ball(rng: np.random.Generator, num: int) -> Float[np.ndarray, "num 3"]:
    direction = rng.normal(size=(num, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return direction * rng.random((num, 1)) ** (1 / 3)


def planted_pairs(
    rng: np.random.Generator,
    num_pairs: int,
    outliers: float,
    blob: str = "isotropic",
    *,
    noise: float = NOISE,
    shift: float = 1.0,
) -> PlantedPairs:
    """Mirror pairs in an ellipsoid of unit radius halved by its mirror, and outlier pairs beside them.

    Of a mirror pair, x is uniform in the ellipsoid and y its mirror image plus normal noise; both ends of an
    outlier pair are independent and uniform in the ellipsoid. The pose is a random rotation and shift.

    Args:
        rng: generator of the randomness.
        num_pairs: number of pairs.
        outliers: share of the pairs that are outliers, rounded to a whole number of pairs.
        blob: "isotropic" (a ball), "thin" (thinnest across its mirror) or "wide" (widest across it).
        noise: standard deviation of each coordinate of y.
        shift: standard deviation of each coordinate of the ellipsoid's centre.

    Returns:
        The pairs, outliers first, and the plane.

    Raises:
        InvalidArgumentError: for an unknown blob or a share outside 0 to 1.
    """
    if blob not in SEMI_AXES:
        raise InvalidArgumentError(f"blob {blob!r} is unknown: choose one of {', '.join(SEMI_AXES)}")
    if not 0 <= outliers <= 1:
        raise InvalidArgumentError(f"outliers must be a share between 0 and 1, not {outliers}")
    axes = np.asarray(SEMI_AXES[blob])
    x = _in_ball(rng, num_pairs) * axes
    y = x * [-1, 1, 1] + noise * rng.normal(size=x.shape)
    num_outliers = round(outliers * num_pairs)
    y[:num_outliers] = _in_ball(rng, num_outliers) * axes
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    centre = shift * rng.normal(size=3)
    normal = frame[:, 0]
    inlier = np.arange(num_pairs) >= num_outliers
    return PlantedPairs(x @ frame.T + centre, y @ frame.T + centre, normal, float(normal @ centre), inlier)
