"""The frame of a cloud's own: principal axes about the mean, in units of the diagonal."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import DegenerateCloudError
from symjax.geometry.similarity import Similarity

FLAT = 1e-6
"""Ratio of singular values below which a cloud counts as collinear or coplanar."""


class OwnFrame(NamedTuple):
    """Points in their own frame, and the way back.

    Attributes:
        points: in their principal frame about their mean, in units of their diagonal.
        to_given: from there to the given coordinates.
        extent: largest coordinate distance from the mean, in the given units.
        rank: dimension that the points span: 1 is a line, 2 a plane.
    """

    points: Float[np.ndarray, "n 3"]
    to_given: Similarity
    extent: float
    rank: int


def in_own_frame(points: Float[np.ndarray, "n 3"], name: str = "points") -> OwnFrame:
    """Brings points into their own frame; each axis is turned to where the points reach further.

    Args:
        points: in any units, anywhere.
        name: what an error calls them.

    Raises:
        DegenerateCloudError: the points coincide.
    """
    centre, extent = _middle(points)
    if extent == 0:
        raise DegenerateCloudError(f"all {len(points)} {name} coincide: no mirror plane is defined")
    unit = (points - centre) / extent
    singular, frame = _principal_frame(unit)
    own = unit @ frame
    # the sign of the third moment
    sign = np.where((own**3).sum(axis=0) < 0, -1.0, 1.0)
    frame, own = frame * sign, own * sign
    diagonal = float(np.linalg.norm(np.ptp(own, axis=0)))
    rank = int(np.count_nonzero(singular >= FLAT * singular[0]))
    return OwnFrame(own / diagonal, Similarity(diagonal * extent, frame, centre), extent, rank)


def _middle(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, " 3"], float]:
    """Mean and largest coordinate distance from it, for coordinates whose squares or sums may overflow."""
    largest = float(np.abs(points).max())
    if largest == 0:
        return np.zeros(3), 0.0
    # a power of two, so that scaling rounds nothing; halved, so that differences stay finite
    scale = 2.0 ** min(np.frexp(largest)[1] + 1, 1023)
    small = points / scale
    centre = small.mean(axis=0)
    return centre * scale, float(np.abs(small - centre).max()) * scale


def _principal_frame(
    points: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, "3 3"]]:
    """Singular values, descending, and the principal axes in columns."""
    _, singular, axes = np.linalg.svd(np.linalg.qr(points, mode="r"))
    return singular, axes.T
