"""Which planes are near each other, and their non-maximum suppression: of planes that are near, the best is kept."""

import math
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from symjax.geometry.arrays import AnyArray
from symjax.geometry.plane import Plane


def near(planes: Plane, plane: Plane, *, angle: float, offset: Float[AnyArray, ""] | float) -> Bool[AnyArray, "*batch"]:
    """Which planes are near a plane: both their normals and their offsets are; v and −v are the same normal.

    NumPy and JAX arrays both work.

    Args:
        planes: unit normals and offsets.
        plane: the one plane that they are compared with.
        angle: largest angle between the normals of planes that are near, in degrees.
        offset: largest difference of their offsets, in the units of the points. Offsets are compared at the origin:
            the frame's origin should be in the middle of the cloud.
    """
    xp: Any = planes.normal.__array_namespace__()
    n, v = planes.normal, plane.normal
    # columns, not a matrix product: on a GPU that would run in TF32
    cosine = n[..., 0] * v[0] + n[..., 1] * v[1] + n[..., 2] * v[2]
    apart = xp.abs(xp.where(cosine < 0, -1, 1) * planes.offset - plane.offset)
    return (xp.abs(cosine) > math.cos(math.radians(angle))) & (apart < offset)


def suppress(
    planes: Plane, order: Int[np.ndarray, " p"], *, angle: float, offset: float, most: int
) -> Int[np.ndarray, " r"]:
    """Rows of the planes that are kept: in the given order, without those near one already kept.

    Args:
        planes: unit normals of shape (n, 3) and offsets of shape (n,).
        order: rows in the order of preference.
        angle: see `near`.
        offset: see `near`.
        most: number of planes that are kept at most.

    Example:
        >>> planes = Plane(np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0]]), np.zeros(3))
        >>> suppress(planes, np.array([2, 0, 1]), angle=5.0, offset=0.02, most=3).tolist()
        [2, 0]
    """
    kept = np.empty(most, dtype=int)
    normals, offsets = np.empty((most, 3)), np.empty(most)
    count = 0
    for row in order:
        if count == most:
            break
        plane = Plane(planes.normal[row], planes.offset[row])
        if not near(Plane(normals[:count], offsets[:count]), plane, angle=angle, offset=offset).any():
            kept[count], normals[count], offsets[count] = row, *plane
            count += 1
    return kept[:count]
