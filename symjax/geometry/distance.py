"""How far an estimated mirror plane is from the true one. NumPy and JAX arrays both work."""

from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from jaxtyping import Float

if TYPE_CHECKING:
    from jaxtyping import Array

    from symjax.geometry.plane import Plane

    AnyArray: TypeAlias = Array | np.ndarray
else:
    # jaxtyping's `Array` would import JAX
    AnyArray = Any
"""An array of JAX or of NumPy."""


def deviation_angle(a: Float[AnyArray, "*batch 3"], b: Float[AnyArray, "*batch 3"]) -> Float[AnyArray, "*batch"]:
    """Angle between two plane normals, signs ignored.

    By atan2(‖a × b‖, |a · b|): arccos has an infinite slope at aligned normals and cannot tell 0.01° from 0°
    in float32.

    Args:
        a: normals, of any length but zero.
        b: normals; leading axes broadcast against those of `a`.

    Returns:
        Degrees, 0 to 90.
    """
    if not hasattr(a, "__array_namespace__"):
        a = np.asarray(a)
    xp: Any = a.__array_namespace__()
    b = xp.asarray(b)
    cross = [a[..., i] * b[..., j] - a[..., j] * b[..., i] for i, j in ((1, 2), (2, 0), (0, 1))]
    dot = xp.abs(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])
    square = cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2
    # the square root's slope at 0 would make a NaN of the derivative at aligned normals
    sine = xp.sqrt(xp.where(square > 0, square, 1)) * (square > 0)
    return xp.degrees(xp.atan2(sine, dot))


def offset_error(
    plane: "Plane", truth: "Plane", centre: Float[AnyArray, "3"], diagonal: float
) -> Float[AnyArray, "*batch"]:
    """Distance of the estimated plane from the foot of the cloud's centre on the true plane.

    Unlike the difference of two offsets, it does not depend on where the origin is.

    Args:
        plane: estimated plane or planes.
        truth: true plane.
        centre: centre of the cloud.
        diagonal: diagonal of the cloud's bounding box, in the units of `centre`.

    Returns:
        The distance as a fraction of the diagonal.
    """
    xp: Any = plane.normal.__array_namespace__()
    centre = xp.asarray(centre)
    foot = centre - ((truth.normal * centre).sum(-1) - truth.offset) * truth.normal
    n = plane.normal
    distance = n[..., 0] * foot[..., 0] + n[..., 1] * foot[..., 1] + n[..., 2] * foot[..., 2] - plane.offset
    return xp.abs(distance) / diagonal
