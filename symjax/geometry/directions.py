"""Directions in space: unit vectors. As normals of mirror planes, v and −v are the same."""

from typing import Any

import numpy as np
from jaxtyping import Float

from symjax.geometry.arrays import AnyArray

_GOLDEN_ANGLE = 2.399963229728653  # π(3 − √5)


def fibonacci(num: int, *, half: bool = True) -> Float[np.ndarray, "num 3"]:
    """Returns `num` nearly uniform directions on a Fibonacci spiral.

    Args:
        num: number of directions.
        half: whether to cover only the upper half of the sphere; v and −v are normals of the same mirror plane.

    Example:
        >>> fibonacci(1)
        array([[0.8660254, 0.       , 0.5      ]])
    """
    fraction = (np.arange(num) + 0.5) / num
    z = 1 - fraction if half else 1 - 2 * fraction
    radius = np.sqrt(1 - z**2)
    angle = _GOLDEN_ANGLE * np.arange(num)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)


def deviation_angle(a: Float[AnyArray, "*#batch 3"], b: Float[AnyArray, "*#batch 3"]) -> Float[AnyArray, "*#batch"]:
    """Computes the angle between two plane normals, ignoring their signs.

    The angle is atan2(‖a × b‖, |a · b|). The arccos of the cosine would have an infinite slope at parallel normals,
    and could not resolve 0.01° in float32.

    Args:
        a: normals of any nonzero length.
        b: normals of any nonzero length; the leading axes of `a` and `b` broadcast.

    Returns:
        Angles in degrees, 0 to 90.

    Example:
        >>> deviation_angle(np.array([0.0, 0.0, 1.0]), np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 1.0]]))
        array([ 0., 45.])
    """
    if not hasattr(a, "__array_namespace__"):
        a = np.asarray(a)
    xp: Any = a.__array_namespace__()
    b = xp.asarray(b)
    cross = [a[..., i] * b[..., j] - a[..., j] * b[..., i] for i, j in ((1, 2), (2, 0), (0, 1))]
    dot = xp.abs(a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2])
    square = cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2
    # the infinite slope of the square root at 0 would make the derivative NaN at parallel normals
    sine = xp.where(square > 0, xp.sqrt(xp.where(square > 0, square, 1)), 0)
    angle: Float[AnyArray, "*#batch"] = xp.degrees(xp.atan2(sine, dot))
    return angle
