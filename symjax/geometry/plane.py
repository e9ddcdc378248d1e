"""The mirror plane."""

from typing import Any, NamedTuple

from jaxtyping import Float

from symjax.geometry.arrays import AnyArray
from symjax.geometry.directions import deviation_angle


class Plane(NamedTuple):
    """The plane `normal · x = offset`, or a batch of them in leading axes.

    A pytree; its methods work on NumPy and on JAX arrays alike. (v, ω) in the paper, Sec. 3.1.

    Attributes:
        normal: unit normal v.
        offset: signed distance ω of the plane from the origin along `normal`, in the units of the points.
    """

    normal: Float[AnyArray, "*batch 3"]
    offset: Float[AnyArray, "*batch"]

    def signed_distance(self, points: Float[AnyArray, "n 3"]) -> Float[AnyArray, "*batch n"]:
        """Distances of points from the plane, positive on the side that the normal points to."""
        xp: Any = self.normal.__array_namespace__()
        points = xp.asarray(points)
        n = self.normal[..., None, :]
        # columns, not a matrix product: on a GPU that would run in TF32
        p = points.reshape((1,) * (self.normal.ndim - 1) + points.shape)
        along = n[..., 0] * p[..., 0] + n[..., 1] * p[..., 1] + n[..., 2] * p[..., 2]
        return along - xp.asarray(self.offset)[..., None]

    def reflect(self, points: Float[AnyArray, "n 3"]) -> Float[AnyArray, "*batch n 3"]:
        """Mirror images of points: x − 2(v·x − ω)v."""
        xp: Any = self.normal.__array_namespace__()
        points = xp.asarray(points)
        step = 2 * self.signed_distance(points)[..., None] * self.normal[..., None, :]
        return points.reshape((1,) * (self.normal.ndim - 1) + points.shape) - step

    def reflect_directions(self, directions: Float[AnyArray, "n 3"]) -> Float[AnyArray, "*batch n 3"]:
        """Mirror images of directions: d − 2(v·d)v."""
        return self._replace(offset=0 * self.offset).reflect(directions)

    def angle(self, other: "Plane") -> Float[AnyArray, "*batch"]:
        """Angle to another plane in degrees, 0 to 90."""
        return deviation_angle(self.normal, other.normal)

    def canonical(self) -> "Plane":
        """The same plane with its normal's largest component positive (the first such, on ties)."""
        xp: Any = self.normal.__array_namespace__()
        largest = xp.argmax(xp.abs(self.normal), axis=-1)[..., None]
        component = xp.take_along_axis(self.normal, largest, axis=-1)[..., 0]
        sign = xp.where(component < 0, -1, 1).astype(self.normal.dtype)
        return Plane(self.normal * sign[..., None], self.offset * sign)

    def matrix(self) -> Float[AnyArray, "*batch 4 4"]:
        """The reflection as a homogeneous matrix: [[I − 2vvᵀ, 2ωv], [0, 1]]."""
        xp: Any = self.normal.__array_namespace__()
        n = self.normal
        eye = xp.eye(3, dtype=n.dtype).reshape((1,) * (n.ndim - 1) + (3, 3))
        linear = eye - 2 * n[..., :, None] * n[..., None, :]
        shift = 2 * (xp.asarray(self.offset)[..., None] * n)[..., None]
        top = xp.concatenate([linear, shift], axis=-1)
        last = xp.broadcast_to(xp.asarray([0.0, 0.0, 0.0, 1.0], dtype=n.dtype), (*n.shape[:-1], 1, 4))
        return xp.concatenate([top, last], axis=-2)
