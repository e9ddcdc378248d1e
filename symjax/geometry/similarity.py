"""Similarities of space, which convert points, planes and directions between frames."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry.arrays import AnyArray
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty


class Similarity(NamedTuple):
    """The map x ↦ scale · Qx + shift, with Q orthogonal: a rotation or a rotoreflection.

    It is a pytree, and its methods accept NumPy and JAX arrays. With leading axes it is a batch of maps, each of which
    applies to its own point, direction or plane.

    Attributes:
        scale: positive factor.
        rotation: matrix Q; None stands for the identity.
        shift: image of the origin, in the units of the images.

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
        """Computes the images of directions, which keep their lengths."""
        xp: Any = directions.__array_namespace__()
        images: Float[AnyArray, "*batch 3"] = xp.stack(self._rotate(directions), axis=-1)
        return images

    def points(self, points: Float[AnyArray, "*batch 3"]) -> Float[AnyArray, "*batch 3"]:
        """Computes the images of points."""
        xp: Any = points.__array_namespace__()
        columns = [self.scale * column + self.shift[..., i] for i, column in enumerate(self._rotate(points))]
        images: Float[AnyArray, "*batch 3"] = xp.stack(columns, axis=-1)
        return images

    def _rotate(self, vectors: Float[AnyArray, "*batch 3"]) -> list[Float[AnyArray, "*batch"]]:
        """Returns the components of Q times each vector.

        They are computed one by one: on a GPU, a matrix product would run in TF32. No rank is promoted either.
        """
        x, y, z = (vectors[..., i] for i in range(3))
        q = self.rotation
        if q is None:
            return [x, y, z]
        return [x * q[..., i, 0] + y * q[..., i, 1] + z * q[..., i, 2] for i in range(3)]

    def plane(self, plane: Plane) -> Plane:
        """Computes the image of a plane, and keeps the sign of its normal."""
        normal = self.directions(plane.normal)
        along = normal[..., 0] * self.shift[..., 0]
        along = along + normal[..., 1] * self.shift[..., 1] + normal[..., 2] * self.shift[..., 2]
        return Plane(normal, self.scale * plane.offset + along)

    def axis(
        self, axis: tuple[Float[AnyArray, " 3"], Float[AnyArray, " 3"]]
    ) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]:
        """Computes the image of an axis, which is a point and a direction."""
        point, direction = axis
        return np.asarray(self.points(point)), np.asarray(self.directions(direction))

    def uncertainty(self, uncertainty: Uncertainty) -> Uncertainty:
        """Computes the uncertainty of the image of an estimated plane.

        The sign of the normal does not matter: if it flips, rotation and shift of the plane flip together, and their
        covariance stays the same.
        """
        scale = np.array([1.0, 1.0, float(self.scale)])
        return Uncertainty(
            uncertainty.covariance * np.outer(scale, scale),
            np.asarray(self.directions(uncertainty.tangents)),
            np.asarray(self.points(uncertainty.centre)),
        )

    def inverse(self) -> "Similarity":
        """Returns the inverse map, x ↦ Qᵀ(x − shift)/scale."""
        xp: Any = self.shift.__array_namespace__()
        transposed = None if self.rotation is None else xp.swapaxes(self.rotation, -1, -2)
        back = Similarity(1 / self.scale, transposed, self.shift)
        return back._replace(shift=xp.stack([-back.scale * column for column in back._rotate(self.shift)], axis=-1))
