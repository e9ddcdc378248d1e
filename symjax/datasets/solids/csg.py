"""Constructive solid geometry with signed distance functions: unions, intersections, differences and rigid motions."""

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.primitives import Coordinates, Distances, Field, Vector


def union(*fields: Field, blend: float = 0.0) -> Field:
    """Unites solids; with `blend` > 0, their joints are filleted over that width.

    The gradient of the polynomial smooth minimum is a convex combination of the gradients of its arguments, so a blend
    of 1-Lipschitz fields is 1-Lipschitz.
    """

    def field(p: Coordinates) -> Distances:
        distance = fields[0](p)
        for part in fields[1:]:
            distance = _smooth_minimum(distance, part(p), blend)
        return distance

    return field


def _smooth_minimum(a: Distances, b: Distances, blend: float) -> Distances:
    minimum: Distances = np.minimum(a, b)
    if blend > 0:
        overlap = np.maximum(blend - np.abs(a - b), 0)
        minimum -= overlap * overlap / (4 * blend)
    return minimum


def difference(solid: Field, *tools: Field, blend: float = 0.0) -> Field:
    """Subtracts the tools from a solid; with `blend` > 0, the new edges are rounded over that width."""

    def field(p: Coordinates) -> Distances:
        distance = -solid(p)
        for tool in tools:
            distance = _smooth_minimum(distance, tool(p), blend)
        return -distance

    return field


def intersection(*fields: Field) -> Field:
    """Intersects solids."""
    return lambda p: np.max([f(p) for f in fields], axis=0)


def fold(field: Field, axis: int = 0) -> Field:
    """Replaces the half x < 0 of a solid by the mirror image of the other half (or y or z, by `axis`).

    The field is evaluated at (|x|, y, z), so it is symmetric to the last bit.
    """

    def folded(p: Coordinates) -> Distances:
        q = p.copy()
        np.abs(q[axis], out=q[axis])
        return field(q)

    return folded


def reflect(field: Field, axis: int = 0) -> Field:
    """Reflects a solid in the coordinate plane x = 0 (or y = 0 or z = 0, by `axis`)."""
    signs = np.ones((3, 1))
    signs[axis] = -1
    return lambda p: field(p * signs)


def translate(field: Field, shift: Vector) -> Field:
    """Translates a solid."""
    s = np.asarray(shift, dtype=float).reshape(3, 1)
    return lambda p: field(p - s)


def rotate(field: Field, axis: int, degrees: float, about: Vector = (0.0, 0.0, 0.0)) -> Field:
    """Rotates a solid by the right-hand rule about the line through `about` along a coordinate axis."""
    rotation = rotation_about(axis, degrees)
    c = np.asarray(about, dtype=float).reshape(3, 1)
    return lambda p: field(rotation.T @ (p - c) + c)


def rotation_about(axis: int, degrees: float) -> Float[np.ndarray, "3 3"]:
    """Returns the rotation matrix about a coordinate axis."""
    angle = np.radians(degrees)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    rotation = np.eye(3)
    rotation[i, i] = rotation[j, j] = np.cos(angle)
    rotation[i, j], rotation[j, i] = -np.sin(angle), np.sin(angle)
    return rotation
