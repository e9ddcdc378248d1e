"""Initial plane: a plane that a user passes as an additional hypothesis."""

import numpy as np

from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane


class InitialPlane(Plane):
    """A plane that compares and hashes by value, so that methods with an initial plane do too; arrays do neither."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Plane) and all(map(np.array_equal, self, other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash((*self.normal.tolist(), float(self.offset)))


def checked_plane(plane: Plane) -> Plane:
    """Returns the plane with a unit normal; raises InvalidArgumentError if it is not a plane."""
    try:
        normal, offset = (np.asarray(part, dtype=float) for part in plane)
    except (TypeError, ValueError):
        normal, offset = np.zeros(0), np.zeros(0)
    if normal.shape != (3,) or offset.shape != () or not np.isfinite([*normal, offset]).all() or not normal.any():
        raise InvalidArgumentError(
            f"init must be a Plane with a finite, nonzero normal of shape (3,) and a finite offset, got {plane!r}"
        )
    length = np.linalg.norm(normal)
    return InitialPlane(normal / length, offset / length)
