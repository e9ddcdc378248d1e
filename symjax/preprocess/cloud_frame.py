"""The cloud frame: principal axes about the mean, in units of the diagonal."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import DegenerateCloudError
from symjax.geometry.similarity import Similarity

FLAT = 1e-6
"""Ratio of singular values below which the points count as collinear or coplanar."""


class FramedPoints(NamedTuple):
    """Points in the cloud frame, and the map back to the given coordinates.

    Attributes:
        points: coordinates along the principal axes about the mean, in units of the diagonal.
        to_given: map from the cloud frame to the given coordinates.
        extent: largest absolute coordinate of the points minus their mean, in the given units.
        rank: dimension of the points: 1 on a line, 2 on a plane, 3 otherwise.
    """

    points: Float[np.ndarray, "n 3"]
    to_given: Similarity
    extent: float
    rank: int


def to_cloud_frame(points: Float[np.ndarray, "n 3"], name: str = "points") -> FramedPoints:
    """Transforms points to the cloud frame.

    The sign of each axis makes the third moment of the coordinates positive.

    Args:
        points: points in any units and at any position.
        name: name of the points in an error message.

    Raises:
        DegenerateCloudError: if the points coincide.
    """
    centre, extent = _mean_and_extent(points)
    if extent == 0:
        raise DegenerateCloudError(f"all {len(points)} {name} coincide, so they define no mirror plane")
    unit = (points - centre) / extent
    singular, frame = _principal_frame(unit)
    rotated = unit @ frame
    sign = np.where((rotated**3).sum(axis=0) < 0, -1.0, 1.0)
    frame, rotated = frame * sign, rotated * sign
    diagonal = float(np.linalg.norm(np.ptp(rotated, axis=0)))
    rank = int(np.count_nonzero(singular >= FLAT * singular[0]))
    return FramedPoints(rotated / diagonal, Similarity(diagonal * extent, frame, centre), extent, rank)


def _mean_and_extent(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, " 3"], float]:
    """Computes the mean and the extent of points whose squares or sums may overflow."""
    largest = float(np.abs(points).max())
    if largest == 0:
        return np.zeros(3), 0.0
    # a power of two does not round, and one that is twice too large keeps differences finite
    scale = 2.0 ** min(np.frexp(largest)[1] + 1, 1023)
    small = points / scale
    centre = small.mean(axis=0)
    return centre * scale, float(np.abs(small - centre).max()) * scale


def _principal_frame(
    points: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, "3 3"]]:
    """Computes the singular values, descending, and the principal axes in columns."""
    _, singular, axes = np.linalg.svd(np.linalg.qr(points, mode="r"))
    return singular, axes.T
