"""Which points belong to the object, and the object completed by its mirror image."""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree

from symjax.geometry.plane import Plane

NEAR = 3.0
"""Distance from a used point, in usual distances between used points, within which a point belongs to the object."""


def on_surface(points: Float[np.ndarray, "n 3"], used: Float[np.ndarray, "m 3"] | None) -> Bool[np.ndarray, " n"]:
    """Which points belong to the object: the finite ones that are near those that were used.

    Args:
        points: the points that are asked about.
        used: points of the object; None if every finite point belongs to it.
    """
    finite = np.asarray(np.isfinite(points).all(axis=1))
    if used is None:
        return finite
    surface = cKDTree(used)
    usual = np.median(surface.query(surface.data, k=2)[0][:, 1])
    finite[finite] = surface.query(points[finite], workers=-1)[0] <= NEAR * usual
    return finite


def complete(points: Float[np.ndarray, "n 3"], plane: Plane) -> Float[np.ndarray, "2*n 3"]:
    """The completed object P ∪ Q of the paper, Sec. 5.6: the points, then their mirror images."""
    return np.concatenate([points, np.asarray(plane.reflect(points))])
