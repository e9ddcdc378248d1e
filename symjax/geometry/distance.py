"""How far an estimated mirror plane is from the true one. NumPy and JAX arrays both work."""

from typing import Any

from jaxtyping import Float

from symjax.geometry.arrays import AnyArray
from symjax.geometry.directions import deviation_angle
from symjax.geometry.plane import Plane

__all__ = ["deviation_angle", "offset_error"]


def offset_error(
    plane: Plane, truth: Plane, centre: Float[AnyArray, " 3"], diagonal: float
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
