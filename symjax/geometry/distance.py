"""Metrics: how far an estimated mirror plane is from the true one. They accept NumPy and JAX arrays."""

from typing import Any

from jaxtyping import Float

from symjax.geometry.arrays import AnyArray
from symjax.geometry.directions import deviation_angle
from symjax.geometry.plane import Plane

__all__ = ["deviation_angle", "offset_error"]


def offset_error(
    plane: Plane, truth: Plane, centre: Float[AnyArray, " 3"], diagonal: float
) -> Float[AnyArray, "*batch"]:
    """Computes the error of an estimated plane's position, as a fraction of the diagonal.

    The error is the distance from the estimated plane to c − (v·c − ω)v, the projection of the cloud's centre c
    onto the true plane (v, ω). Unlike the difference of the two offsets, it does not depend on the origin.

    Args:
        plane: estimated plane, or a batch of planes.
        truth: true plane.
        centre: centre of the cloud.
        diagonal: length of the diagonal of the cloud's bounding box, in the units of `centre`.

    Returns:
        The distance divided by the diagonal.

    Example:
        >>> import numpy as np
        >>> from symjax.geometry.plane import Plane
        >>> truth = Plane(np.array([0.0, 0.0, 1.0]), np.array(1.0))
        >>> estimate = Plane(np.array([0.0, 0.0, 1.0]), np.array(1.5))
        >>> print(offset_error(estimate, truth, np.zeros(3), diagonal=2.0))
        0.25
    """
    xp: Any = plane.normal.__array_namespace__()
    centre = xp.asarray(centre)
    foot = centre - ((truth.normal * centre).sum(-1) - truth.offset) * truth.normal
    n = plane.normal
    distance = n[..., 0] * foot[..., 0] + n[..., 1] * foot[..., 1] + n[..., 2] * foot[..., 2] - plane.offset
    error: Float[AnyArray, "*batch"] = xp.abs(distance) / diagonal
    return error
