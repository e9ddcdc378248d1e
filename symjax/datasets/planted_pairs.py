"""Random pairs with a known mirror plane, to test the estimator on. NumPy only."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from symjax.errors import InvalidArgumentError
from symjax.geometry.checks import choice

NOISE = 0.01
"""Default standard deviation of the noise in each coordinate, for an ellipsoid of about unit radius."""

SEMI_AXES = {"isotropic": (1.0, 1.0, 1.0), "thin": (0.4, 0.7, 1.0), "wide": (1.0, 0.7, 0.4)}
"""Semi-axes of each ellipsoid: along the normal of the mirror plane, and along two directions within the plane."""


class PlantedPairs(NamedTuple):
    """Pairs of points with a known mirror plane.

    Attributes:
        x: one end of every pair.
        y: the other end.
        normal: unit normal of the mirror plane `normal · x = offset`.
        offset: offset of the mirror plane.
        inlier: whether each pair is a mirror pair.
    """

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, " 3"]
    offset: float
    inlier: Bool[np.ndarray, " n"]


def _in_ball(rng: np.random.Generator, num: int) -> Float[np.ndarray, "{num} 3"]:
    """Returns random points, uniform in the unit ball."""
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
    """Draws mirror pairs and outlier pairs in an ellipsoid whose longest semi-axis is 1.

    The mirror plane contains the ellipsoid's centre and two of its axes. In a mirror pair, x is uniform in the
    ellipsoid, and y is its mirror image plus Gaussian noise. In an outlier pair, x and y are independent and uniform
    in the ellipsoid. The ellipsoid is rotated and shifted at random.

    Args:
        rng: generator of the pairs and the pose.
        num_pairs: number of pairs.
        outliers: fraction of outlier pairs, rounded to a whole number of pairs.
        blob: shape of the ellipsoid: "isotropic" (a ball), "thin" (shortest axis along the normal) or "wide" (longest
            axis along the normal).
        noise: standard deviation of the noise in each coordinate of y.
        shift: standard deviation of each coordinate of the ellipsoid's centre.

    Returns:
        The pairs, outliers first, and the plane.

    Raises:
        InvalidArgumentError: if the blob is unknown, or `outliers` is not in [0, 1].

    Example:
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, 0.3)
        >>> pairs.x.shape, int(pairs.inlier.sum())
        ((100, 3), 70)
    """
    choice("blob", blob, SEMI_AXES)
    if not 0 <= outliers <= 1:
        raise InvalidArgumentError(f"outliers must be a fraction between 0 and 1, got {outliers}")
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
