"""A solid in its own frame with the symmetries that it has by construction."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.csg import fold, union
from symjax.datasets.solids.primitives import Field

Axis = tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]


class Solid(NamedTuple):
    """Signed distance function and every mirror plane `normal . x = offset` of its zero set.

    With an `axis` (point, direction) the planes through it are symmetries as well, and not listed.
    """

    field: Field
    normals: Float[np.ndarray, "p 3"]
    offsets: Float[np.ndarray, " p"]
    axis: Axis | None = None


def with_planes(field: Field, normals: Sequence[Sequence[float]], axis: Axis | None = None) -> Solid:
    """Solid with mirror planes through the origin."""
    n = np.asarray(normals, dtype=float).reshape(-1, 3)
    return Solid(field, n, np.zeros(len(n)), axis)


def mirrored(*parts: Field, blend: float = 0.0) -> Solid:
    """Union of the parts at x ≥ 0 and of their mirror images across x = 0, its one plane."""
    return with_planes(fold(union(*parts, blend=blend)), [[1, 0, 0]])


def lopsided(field: Field) -> Solid:
    """Solid without a mirror plane."""
    return with_planes(field, [])


def revolved(field: Field, normals: Sequence[Sequence[float]] = ()) -> Solid:
    """Solid of revolution about z, with the mirror planes that do not contain the axis."""
    return with_planes(field, normals, axis=(np.zeros(3), np.array([0.0, 0.0, 1.0])))
