"""The mirror plane."""

from typing import Any, NamedTuple

from jaxtyping import Float

from symjax.geometry.arrays import AnyArray
from symjax.geometry.directions import deviation_angle


class Plane(NamedTuple):
    """The plane `normal · x = offset`, or a batch of planes in leading axes.

    It is a pytree, and its methods accept NumPy and JAX arrays. The paper calls it (v, ω), Sec. 3.1.

    Attributes:
        normal: unit normal v.
        offset: signed distance ω of the plane from the origin along `normal`, in the units of the points.

    Example:
        >>> import numpy as np
        >>> plane = Plane(normal=np.array([1.0, 0.0, 0.0]), offset=np.array(2.0))
        >>> points = np.array([[0.0, 5.0, 1.0], [3.0, 0.0, 0.0]])
        >>> plane.signed_distance(points)
        array([-2.,  1.])
        >>> plane.reflect(points)
        array([[4., 5., 1.],
               [1., 0., 0.]])
    """

    normal: Float[AnyArray, "*batch 3"]
    offset: Float[AnyArray, "*batch"]

    def signed_distance(self, points: Float[AnyArray, "n 3"]) -> Float[AnyArray, "*batch n"]:
        """Computes v·x − ω, positive on the side that the normal points to.

        Args:
            points: points x, in the units of the offset.

        Returns:
            Distances in the same units.
        """
        xp: Any = self.normal.__array_namespace__()
        points = xp.asarray(points)
        n = self.normal[..., None, :]
        # column by column: on a GPU, a matrix product would run in TF32
        p = points.reshape((1,) * (self.normal.ndim - 1) + points.shape)
        along = n[..., 0] * p[..., 0] + n[..., 1] * p[..., 1] + n[..., 2] * p[..., 2]
        distance: Float[AnyArray, "*batch n"] = along - xp.asarray(self.offset)[..., None]
        return distance

    def reflect(self, points: Float[AnyArray, "n 3"]) -> Float[AnyArray, "*batch n 3"]:
        """Computes the mirror images of points, x − 2(v·x − ω)v.

        Args:
            points: points x, in the units of the offset.

        Returns:
            The mirror images in each plane of the batch.
        """
        xp: Any = self.normal.__array_namespace__()
        points = xp.asarray(points)
        step = 2 * self.signed_distance(points)[..., None] * self.normal[..., None, :]
        return points.reshape((1,) * (self.normal.ndim - 1) + points.shape) - step

    def reflect_directions(self, directions: Float[AnyArray, "n 3"]) -> Float[AnyArray, "*batch n 3"]:
        """Computes the mirror images of directions, d − 2(v·d)v.

        Args:
            directions: vectors d of any length.

        Returns:
            The mirror images in each plane of the batch.
        """
        return self._replace(offset=0 * self.offset).reflect(directions)

    def angle(self, other: "Plane") -> Float[AnyArray, "*batch"]:
        """Computes the angle to another plane, ignoring the signs of the normals.

        Args:
            other: plane, or a batch of planes that broadcasts.

        Returns:
            Angles in degrees, 0 to 90; see `symjax.metrics.deviation_angle`.
        """
        return deviation_angle(self.normal, other.normal)

    def canonical(self) -> "Plane":
        """Returns the same plane with the sign that makes the largest component of the normal positive.

        If several components are largest, the first decides.
        """
        xp: Any = self.normal.__array_namespace__()
        largest = xp.argmax(xp.abs(self.normal), axis=-1)[..., None]
        component = xp.take_along_axis(self.normal, largest, axis=-1)[..., 0]
        sign = xp.where(component < 0, -1, 1).astype(self.normal.dtype)
        return Plane(self.normal * sign[..., None], self.offset * sign)

    def matrix(self) -> Float[AnyArray, "*batch 4 4"]:
        """Returns the reflection as a homogeneous matrix, [[I − 2vvᵀ, 2ωv], [0, 1]]."""
        xp: Any = self.normal.__array_namespace__()
        n = self.normal
        eye = xp.eye(3, dtype=n.dtype).reshape((1,) * (n.ndim - 1) + (3, 3))
        linear = eye - 2 * n[..., :, None] * n[..., None, :]
        shift = 2 * (xp.asarray(self.offset)[..., None] * n)[..., None]
        top = xp.concatenate([linear, shift], axis=-1)
        last = xp.broadcast_to(xp.asarray([0.0, 0.0, 0.0, 1.0], dtype=n.dtype), (*n.shape[:-1], 1, 4))
        matrix: Float[AnyArray, "*batch 4 4"] = xp.concatenate([top, last], axis=-2)
        return matrix
