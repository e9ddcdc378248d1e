"""Deviation angle and true offset error of an answer, also where the right planes are all those through an axis."""

from typing import NamedTuple

import numpy as np

from experiments.data.cases import Case
from symjax.geometry.distance import offset_error
from symjax.geometry.plane import Plane

WITHIN_ANGLE, WITHIN_OFFSET = 5.0, 0.02
"""Largest angle (degrees) and distance (diagonals) of a right plane."""


class Deviation(NamedTuple):
    """How far a plane is from the nearest right one: degrees, and diagonals at the middle of the whole object."""

    angle: float
    offset: float

    @property
    def right(self) -> bool:
        """Whether both are within their limits."""
        return self.angle < WITHIN_ANGLE and self.offset < WITHIN_OFFSET


def deviation(plane: Plane, case: Case) -> Deviation:
    """How far a plane is from the nearest right one, in degrees and diagonals.

    The offset error is |n · c − ω| / diagonal with c the foot of the cloud's mean on the right plane
    (`symjax.geometry.distance.offset_error`): unlike |ω − ω′| it does not depend on where the origin is.

    Args:
        plane: the answer.
        case: the whole object; with an axis, every plane through the axis is right as well.

    Returns:
        Degrees and diagonals; NaN where nothing is right.
    """
    planes = case.planes if case.axis is None else (*case.planes, _through_axis(plane, case.axis))
    if not planes:
        return Deviation(np.nan, np.nan)
    nearest = min(planes, key=lambda right: float(plane.angle(right)))
    offset = offset_error(plane, nearest, case.points.mean(axis=0), case.diagonal)
    return Deviation(float(plane.angle(nearest)), float(offset))


def _through_axis(plane: Plane, axis: tuple[np.ndarray, np.ndarray]) -> Plane:
    """The plane through an axis whose normal is nearest to that of a plane."""
    point, direction = axis
    direction = direction / np.linalg.norm(direction)
    across = plane.normal - (plane.normal @ direction) * direction
    if np.linalg.norm(across) < 1e-9:
        # all planes through the axis are at 90 degrees: any will do
        across = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    normal = across / np.linalg.norm(across)
    return Plane(normal, np.asarray(normal @ point))
