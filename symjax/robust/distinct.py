"""Which planes count as one candidate."""

import numpy as np
from jaxtyping import Int

from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import near, suppress

SAME_ANGLE, SAME_OFFSET = 4.0, 0.02
"""Planes nearer than this (degrees, diagonals) are one candidate."""


def is_same_candidate(a: Plane, b: Plane) -> bool:
    """Whether two planes are one candidate."""
    return bool(near(a, b, angle=SAME_ANGLE, offset=SAME_OFFSET))


def distinct(planes: Plane, order: Int[np.ndarray, " p"], most: int) -> Int[np.ndarray, " r"]:
    """Rows of at most `most` distinct planes, in the order of preference."""
    return suppress(planes, order, angle=SAME_ANGLE, offset=SAME_OFFSET, most=most)
