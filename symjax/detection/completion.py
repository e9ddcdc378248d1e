"""Selection of the points that belong to the object, and completion of the object by its mirror image."""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree

from symjax.geometry.plane import Plane

NEAR = 3.0
"""A point belongs to the object if it is within this many nearest-neighbour distances (the median) of a used point."""


def on_surface(points: Float[np.ndarray, "n 3"], used: Float[np.ndarray, "m 3"] | None) -> Bool[np.ndarray, " n"]:
    """Finds which points belong to the object: the finite ones near the points that were used.

    Args:
        points: the points to test.
        used: points of the object; None if every finite point belongs to it.

    Returns:
        True for each point that belongs to the object.
    """
    finite = np.asarray(np.isfinite(points).all(axis=1))
    if used is None:
        return finite
    surface = cKDTree(used)
    typical = np.median(surface.query(surface.data, k=2)[0][:, 1])
    finite[finite] = surface.query(points[finite], workers=-1)[0] <= NEAR * typical
    return finite


def complete(points: Float[np.ndarray, "n 3"], plane: Plane) -> Float[np.ndarray, "2*n 3"]:
    """Returns the completed object P ∪ Q of the paper, Sec. 5.6: the points, then their mirror images."""
    return np.concatenate([points, np.asarray(plane.reflect(points))])
