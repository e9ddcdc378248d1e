"""Non-maximum suppression of planes: of planes that are nearly the same, the best one is kept."""

import numpy as np
from jaxtyping import Int

from symjax.geometry.plane import Plane


def suppress(
    planes: Plane, order: Int[np.ndarray, "p"], *, angle: float, offset: float, most: int
) -> Int[np.ndarray, "r"]:
    """Rows of the planes that are kept: in the given order, without those near one already kept.

    Two planes are near each other where both their normals and their offsets are; v and −v are the same normal.

    Args:
        planes: unit normals of shape (n, 3) and offsets of shape (n,).
        order: rows in the order of preference.
        angle: largest angle between the normals of planes that are near, in degrees.
        offset: largest difference of their offsets, in the units of the points. Offsets are compared at the origin:
            the frame's origin should be in the middle of the cloud.
        most: number of planes that are kept at most.

    Example:
        >>> planes = Plane(np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0]]), np.zeros(3))
        >>> suppress(planes, np.array([2, 0, 1]), angle=5.0, offset=0.02, most=3).tolist()
        [2, 0]
    """
    least = np.cos(np.radians(angle))
    kept = np.empty(most, dtype=int)
    normals, offsets = np.empty((most, 3)), np.empty(most)
    count = 0
    for row in order:
        if count == most:
            break
        cosine = normals[:count] @ planes.normal[row]
        apart = np.abs(offsets[:count] - np.where(cosine < 0, -1, 1) * planes.offset[row])
        if not ((np.abs(cosine) > least) & (apart < offset)).any():
            kept[count], normals[count], offsets[count] = row, planes.normal[row], planes.offset[row]
            count += 1
    return kept[:count]


def is_same(a: Plane, b: Plane, *, angle: float, offset: float) -> bool:
    """Whether two planes are near each other, see `suppress`."""
    both = Plane(np.stack([a.normal, b.normal]), np.array([a.offset, b.offset]))
    return len(suppress(both, np.arange(2), angle=angle, offset=offset, most=2)) == 1
