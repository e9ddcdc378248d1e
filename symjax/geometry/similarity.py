"""Similarities of space: the one way from a frame to another, and back."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry.arrays import AnyArray
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty


class Similarity(NamedTuple):
    """The map x ↦ scale · Qx + shift, with Q orthogonal: a rotation or a rotoreflection.

    A pytree; its methods work on NumPy and on JAX arrays alike. With leading axes it is a batch of maps, one for each
    point, direction or plane.

    Attributes:
        scale: positive factor.
        rotation: the matrix Q; None is the identity.
        shift: image of the origin.

    Example:
        >>> import numpy as np
        >>> to_given = Similarity(2.0, None, np.array([1.0, 0.0, 0.0]))
        >>> to_given.points(np.array([[0.5, 0.0, 0.0]]))
        array([[2., 0., 0.]])
        >>> to_given.inverse().points(np.array([[2.0, 0.0, 0.0]]))
        array([[0.5, 0. , 0. ]])
    """

    scale: Float[AnyArray, "*batch"] | float
    rotation: Float[AnyArray, "*batch 3 3"] | None
    shift: Float[AnyArray, "*batch 3"]

    def directions(self, directions: Float[AnyArray, "*batch 3"]) -> Float[AnyArray, "*batch 3"]:
        """Images of directions: turned, of the same length."""
        xp: Any = directions.__array_namespace__()
        return xp.stack(self._turned(directions), axis=-1)

    def points(self, points: Float[AnyArray, "*batch 3"]) -> Float[AnyArray, "*batch 3"]:
        """Images of points."""
        xp: Any = points.__array_namespace__()
        moved = [self.scale * part + self.shift[..., i] for i, part in enumerate(self._turned(points))]
        return xp.stack(moved, axis=-1)

    def _turned(self, vectors: Float[AnyArray, "*batch 3"]) -> list[Float[AnyArray, "*batch"]]:
        """The components of Q times each vector.

        One by one: a matrix product would run in TF32 on a GPU, and no rank is promoted.
        """
        x, y, z = (vectors[..., i] for i in range(3))
        q = self.rotation
        if q is None:
            return [x, y, z]
        return [x * q[..., i, 0] + y * q[..., i, 1] + z * q[..., i, 2] for i in range(3)]

    def plane(self, plane: Plane) -> Plane:
        """Image of a plane; the sign of its normal is kept."""
        normal = self.directions(plane.normal)
        along = normal[..., 0] * self.shift[..., 0]
        along = along + normal[..., 1] * self.shift[..., 1] + normal[..., 2] * self.shift[..., 2]
        return Plane(normal, self.scale * plane.offset + along)

    def axis(
        self, axis: tuple[Float[AnyArray, " 3"], Float[AnyArray, " 3"]]
    ) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]:
        """Image of an axis, given by a point and a direction."""
        point, direction = axis
        return np.asarray(self.points(point)), np.asarray(self.directions(direction))

    def uncertainty(self, uncertainty: Uncertainty) -> Uncertainty:
        """Covariance of the image of an estimated plane.

        If the plane's normal is turned round, turn and offset change sign together, and their covariance stands.
        """
        scale = np.array([1.0, 1.0, float(self.scale)])
        return Uncertainty(
            uncertainty.covariance * np.outer(scale, scale),
            np.asarray(self.directions(uncertainty.tangents)),
            np.asarray(self.points(uncertainty.centre)),
        )

    def inverse(self) -> "Similarity":
        """The way back: x ↦ Qᵀ(x − shift)/scale."""
        xp: Any = self.shift.__array_namespace__()
        turned_back = None if self.rotation is None else xp.swapaxes(self.rotation, -1, -2)
        back = Similarity(1 / self.scale, turned_back, self.shift)
        return back._replace(shift=xp.stack([-back.scale * part for part in back._turned(self.shift)], axis=-1))
