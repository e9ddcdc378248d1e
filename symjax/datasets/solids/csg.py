"""Solids put together: unions, differences, and moves of signed distance functions."""

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.primitives import Field, Vector


def union(*fields: Field, blend: float = 0.0) -> Field:
    """The outer surface of several solids; with `blend` > 0 their joints are filleted over that width.

    The polynomial smooth minimum's gradient is a convex combination of its arguments' gradients: a blend of
    1-Lipschitz fields is 1-Lipschitz.
    """

    def field(p: np.ndarray) -> np.ndarray:
        distance = fields[0](p)
        for part in fields[1:]:
            distance = _smooth_minimum(distance, part(p), blend)
        return distance

    return field


def _smooth_minimum(a: np.ndarray, b: np.ndarray, blend: float) -> np.ndarray:
    if blend == 0:
        return np.minimum(a, b)
    overlap = np.maximum(blend - np.abs(a - b), 0)
    return np.minimum(a, b) - overlap * overlap / (4 * blend)


def cut(solid: Field, *tools: Field, blend: float = 0.0) -> Field:
    """The solid less the tools; with `blend` > 0 the rims are rounded over that width."""

    def field(p: np.ndarray) -> np.ndarray:
        distance = -solid(p)
        for tool in tools:
            distance = _smooth_minimum(distance, tool(p), blend)
        return -distance

    return field


def common(*fields: Field) -> Field:
    """The part that all solids share."""
    return lambda p: np.max([f(p) for f in fields], axis=0)


def fold(field: Field, axis: int = 0) -> Field:
    """The field of `(|x|, y, z)`: symmetric about `x = 0` to the last bit."""

    def folded(p: np.ndarray) -> np.ndarray:
        q = p.copy()
        np.abs(q[axis], out=q[axis])
        return field(q)

    return folded


def flip(field: Field, axis: int = 0) -> Field:
    """The solid's mirror image across the coordinate plane `x = 0`."""
    signs = np.ones((3, 1))
    signs[axis] = -1
    return lambda p: field(p * signs)


def move(field: Field, shift: Vector) -> Field:
    """The solid shifted."""
    s = np.asarray(shift, dtype=float).reshape(3, 1)
    return lambda p: field(p - s)


def turn(field: Field, axis: int, degrees: float, about: Vector = (0.0, 0.0, 0.0)) -> Field:
    """The solid turned about a line along a coordinate axis, through `about`, by the right-hand rule."""
    rotation = rotation_about(axis, degrees)
    c = np.asarray(about, dtype=float).reshape(3, 1)
    return lambda p: field(rotation.T @ (p - c) + c)


def rotation_about(axis: int, degrees: float) -> Float[np.ndarray, "3 3"]:
    """Rotation matrix about a coordinate axis."""
    angle = np.radians(degrees)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.eye(3)
    rotation[i, i] = rotation[j, j] = np.cos(angle)
    rotation[i, j], rotation[j, i] = -np.sin(angle), np.sin(angle)
    return rotation
