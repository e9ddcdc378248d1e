"""Non-maximum suppression of planes: of several planes that are near each other, it keeps only the best."""

import math
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from symjax.geometry.arrays import AnyArray
from symjax.geometry.plane import Plane


def near(planes: Plane, plane: Plane, *, angle: float, offset: Float[AnyArray, ""] | float) -> Bool[AnyArray, "*batch"]:
    """Finds the planes that are near a given plane, both in their normals and in their offsets.

    The signs of the normals do not matter. NumPy and JAX arrays are accepted.

    Args:
        planes: unit normals and offsets.
        plane: the plane to compare them with.
        angle: largest angle between the normals of near planes, in degrees.
        offset: largest difference between the offsets of near planes, in the units of the points. Offsets are compared
            at the origin, so the origin should be in the middle of the cloud.

    Returns:
        True for each plane that is near.
    """
    xp: Any = planes.normal.__array_namespace__()
    n, v = planes.normal, plane.normal
    # column by column: on a GPU, a matrix product would run in TF32
    cosine = n[..., 0] * v[0] + n[..., 1] * v[1] + n[..., 2] * v[2]
    apart = xp.abs(xp.where(cosine < 0, -1, 1) * planes.offset - plane.offset)
    is_near: Bool[AnyArray, "*batch"] = (xp.abs(cosine) > math.cos(math.radians(angle))) & (apart < offset)
    return is_near


def suppress(
    planes: Plane, order: Int[np.ndarray, " p"], *, angle: float, offset: float, most: int
) -> Int[np.ndarray, " r"]:
    """Goes through planes in order of preference, and keeps each one that is not near a plane already kept.

    Args:
        planes: unit normals of shape (n, 3) and offsets of shape (n,).
        order: rows of the planes, the best first.
        angle: see `near`.
        offset: see `near`.
        most: largest number of planes to keep.

    Returns:
        Rows of the planes that are kept, the best first.

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
