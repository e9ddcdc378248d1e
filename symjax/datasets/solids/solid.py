"""A solid in its own frame, with the mirror planes that it has by construction."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.csg import fold, union
from symjax.datasets.solids.primitives import Field

Axis = tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]


class Solid(NamedTuple):
    """A solid given by its signed distance function, and all of its mirror planes.

    Attributes:
        field: signed distance function. It takes coordinates of shape (3, n) and returns n values: negative inside the
            solid, zero on its surface, positive outside. The values approximate the distance to the surface.
        normals: unit normals of the mirror planes `normals[i] · x = offsets[i]`.
        offsets: offsets of the mirror planes.
        axis: a point on the axis of a continuous symmetry and the axis's direction, or None. Every plane through the
            axis is a mirror plane; `normals` does not list these planes.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> table = symjax.datasets.build("table")
        >>> points = np.random.default_rng(0).uniform(-1, 1, (3, 100))
        >>> for normal, offset in zip(table.normals, table.offsets, strict=True):
        ...     images = points - 2 * np.outer(normal, normal @ points - offset)
        ...     print(normal, abs(table.field(images) - table.field(points)).max())
        [1. 0. 0.] 0.0
        [0. 1. 0.] 0.0
    """

    field: Field
    normals: Float[np.ndarray, "p 3"]
    offsets: Float[np.ndarray, " p"]
    axis: Axis | None = None


def with_planes(field: Field, normals: Sequence[Sequence[float]], axis: Axis | None = None) -> Solid:
    """Makes a solid with mirror planes through the origin."""
    n = np.asarray(normals, dtype=float).reshape(-1, 3)
    return Solid(field, n, np.zeros(len(n)), axis)


def mirrored(*parts: Field, blend: float = 0.0) -> Solid:
    """Unites the parts at x ≥ 0 with their mirror images across x = 0, the solid's only mirror plane."""
    return with_planes(fold(union(*parts, blend=blend)), [[1, 0, 0]])


def without_planes(field: Field) -> Solid:
    """Makes a solid without a mirror plane."""
    return with_planes(field, [])


def revolved(field: Field, normals: Sequence[Sequence[float]] = ()) -> Solid:
    """Makes a solid of revolution about z; `normals` are those of its mirror planes that do not contain the axis."""
    return with_planes(field, normals, axis=(np.zeros(3), np.array([0.0, 0.0, 1.0])))
