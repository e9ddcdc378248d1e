"""Directions in space: unit vectors, of which v and −v are the same mirror normal."""

from typing import Any

import numpy as np
from jaxtyping import Float

from symjax.geometry.arrays import AnyArray

_GOLDEN_ANGLE = 2.399963229728653  # π(3 − √5)


def fibonacci(num: int, *, half: bool = True) -> Float[np.ndarray, "num 3"]:
    """`num` nearly uniform directions on a Fibonacci spiral.

    Args:
        num: number of directions.
        half: cover the upper half of the sphere only: v and −v are the same mirror.

    Example:
        >>> fibonacci(1)
        array([[0.8660254, 0.       , 0.5      ]])
    """
    share = (np.arange(num) + 0.5) / num
    z = 1 - share if half else 1 - 2 * share
    radius = np.sqrt(1 - z**2)
    angle = _GOLDEN_ANGLE * np.arange(num)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)


def deviation_angle(a: Float[AnyArray, "*#batch 3"], b: Float[AnyArray, "*#batch 3"]) -> Float[AnyArray, "*#batch"]:
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
    sine = xp.where(square > 0, xp.sqrt(xp.where(square > 0, square, 1)), 0)
    return xp.degrees(xp.atan2(sine, dot))
