"""Duplicates: planes so close to each other that they count as one candidate."""

import numpy as np
from jaxtyping import Int

from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import near, suppress

SAME_ANGLE, SAME_OFFSET = 4.0, 0.02
"""Two planes are duplicates if they differ by less than this angle (degrees) and this offset (diagonals)."""


def are_duplicates(a: Plane, b: Plane) -> bool:
    """Returns whether two planes count as one candidate."""
    return bool(near(a, b, angle=SAME_ANGLE, offset=SAME_OFFSET))


def drop_duplicates(planes: Plane, order: Int[np.ndarray, " p"], most: int) -> Int[np.ndarray, " r"]:
    """Returns the rows of the first planes in an order, without duplicates of earlier ones.

    Args:
        planes: a batch of planes, with offsets in diagonals.
        order: rows of the planes, the best first.
        most: maximum number of rows that are returned.
    """
    return suppress(planes, order, angle=SAME_ANGLE, offset=SAME_OFFSET, most=most)
