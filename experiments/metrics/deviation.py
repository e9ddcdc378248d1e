"""Deviation angle and offset error of a plane, also for objects of which every plane through an axis is correct."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data.cases import Case
from symjax.geometry.distance import offset_error
from symjax.geometry.plane import Plane

WITHIN_ANGLE, WITHIN_OFFSET = 5.0, 0.02
"""Largest angle (degrees) and offset error (diagonals) of a correct plane."""


class Deviation(NamedTuple):
    """Deviation of a plane from the nearest true plane.

    Attributes:
        angle: angle between the normals, in degrees.
        offset: offset error at the centre of the whole object, in diagonals.
    """

    angle: float
    offset: float

    @property
    def correct(self) -> bool:
        """Whether both the angle and the offset error are within their limits."""
        return self.angle < WITHIN_ANGLE and self.offset < WITHIN_OFFSET


def deviation(plane: Plane, case: Case) -> Deviation:
    """Computes the deviation of a plane from the nearest true plane of a case.

    The offset error is |n · c − ω| / diagonal, where c is the projection of the cloud's mean onto the true plane
    (`symjax.geometry.distance.offset_error`). Unlike |ω − ω′|, it does not depend on the origin.

    Args:
        plane: the detected plane.
        case: the whole object; if it has an axis, every plane through the axis is correct as well.

    Returns:
        The deviation; NaN if the case has no true plane.
    """
    planes = case.planes if case.axis is None else (*case.planes, _through_axis(plane, case.axis))
    if not planes:
        return Deviation(np.nan, np.nan)
    nearest = min(planes, key=lambda truth: float(plane.angle(truth)))
    offset = offset_error(plane, nearest, case.points.mean(axis=0), case.diagonal)
    return Deviation(float(plane.angle(nearest)), float(offset))


def _through_axis(plane: Plane, axis: tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]) -> Plane:
    """Returns the plane through an axis whose normal is nearest to that of a plane."""
    point, direction = axis
    direction = direction / np.linalg.norm(direction)
    across = plane.normal - (plane.normal @ direction) * direction
    if np.linalg.norm(across) < 1e-9:
        # all planes through the axis are at 90 degrees to this plane: any of them will do
        across = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    normal = across / np.linalg.norm(across)
    return Plane(normal, np.asarray(normal @ point))
