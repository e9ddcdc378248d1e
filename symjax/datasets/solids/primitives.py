"""Primitive solids as signed distance functions: negative inside, zero on the surface, positive outside.

A `Field` takes coordinates of shape (3, n), so `p[0]`, `p[1]` and `p[2]` are contiguous. The sampler relies on
one property: |f| is at most `surface.LIPSCHITZ` times the distance to the surface. The formulas are standard and
collected in Quilez, "Distance functions" (iquilezles.org).
"""

from collections.abc import Callable, Sequence

import numpy as np
from jaxtyping import Float

Coordinates = Float[np.ndarray, "3 n"]
Distances = Float[np.ndarray, " n"]
Field = Callable[[Coordinates], Distances]
Vector = Sequence[float] | Float[np.ndarray, " 3"]


def _column(vector: Vector) -> Float[np.ndarray, "3 1"]:
    return np.asarray(vector, dtype=float).reshape(3, 1)


def _norm(*components: Distances) -> Distances:
    length: Distances = np.sqrt(sum(c * c for c in components))
    return length


def _cylindrical(start: Vector, end: Vector) -> Callable[[Coordinates], tuple[Distances, Distances, float]]:
    """Returns a function to (height above `start` along the segment, distance from its line, length of the segment)."""
    a = _column(start)
    axis = _column(end) - a
    length = float(np.linalg.norm(axis))
    axis = axis / length

    def split(p: Coordinates) -> tuple[Distances, Distances, float]:
        q = p - a
        height = axis[0, 0] * q[0] + axis[1, 0] * q[1] + axis[2, 0] * q[2]
        return height, _norm(*(q - axis * height)), length

    return split


def sphere(centre: Vector, radius: float) -> Field:
    """Makes a ball."""
    c = _column(centre)
    return lambda p: _norm(*(p - c)) - radius


def ellipsoid(centre: Vector, radii: Vector) -> Field:
    """Makes an ellipsoid along the coordinate axes.

    The field is an approximate distance. On the surface, its value and its gradient are those of the exact distance.
    With k = |x/r|, the first-order distance is (k - 1) / |∇k|. Since k is convex, this is a lower bound outside.
    Inside, it can be too large by the ratio of the axes. There the length 1/|∇k| is blended into the smallest radius,
    and the value is bounded below by minus that radius.
    """
    c, r = _column(centre), _column(radii)
    least = float(r.min())

    def field(p: Coordinates) -> Distances:
        q = (p - c) / r
        k = _norm(*q)
        length = k / np.maximum(_norm(*(q / r)), 1e-12)
        inward = least + np.minimum(k, 1) ** 4 * (length - least)
        distance: Distances = np.maximum((k - 1) * np.where(k < 1, inward, length), -least)
        return distance

    return field


def box(centre: Vector, half: Vector, rounding: float = 0.0) -> Field:
    """Makes a box of half-sizes `half` along the coordinate axes; its edges are rounded by `rounding`, inwards."""
    c, inner = _column(centre), _column(half) - rounding

    def field(p: Coordinates) -> Distances:
        q = np.abs(p - c) - inner
        outside = np.maximum(q, 0)
        distance: Distances = _norm(*outside) + np.minimum(q.max(axis=0), 0) - rounding
        return distance

    return field


def capsule(start: Vector, end: Vector, radius: float, end_radius: float | None = None) -> Field:
    """Sweeps a ball from `start` to `end` while its radius changes linearly to `end_radius`."""
    final = radius if end_radius is None else end_radius
    split = _cylindrical(start, end)

    def field(p: Coordinates) -> Distances:
        height, radial, length = split(p)
        sine = (radius - final) / length
        cosine = np.sqrt(1 - sine * sine)
        # the side is a cone; `reach` is the position along the axis whose ball is nearest to the point
        reach = np.clip((height * cosine - radial * sine) / (cosine * length), 0, 1)
        distance: Distances = _norm(height - reach * length, radial) - (radius + reach * (final - radius))
        return distance

    return field


def cylinder(start: Vector, end: Vector, radius: float, rounding: float = 0.0) -> Field:
    """Makes a capped cylinder; its edges are rounded by `rounding`, inwards."""
    split = _cylindrical(start, end)

    def field(p: Coordinates) -> Distances:
        height, radial, length = split(p)
        beyond = np.abs(height - length / 2) - length / 2 + rounding
        sideways = radial - radius + rounding
        corner = _norm(np.maximum(beyond, 0), np.maximum(sideways, 0))
        return corner + np.minimum(np.maximum(beyond, sideways), 0) - rounding

    return field


def frustum(start: Vector, end: Vector, radius: float, end_radius: float) -> Field:
    """Makes a conical frustum with flat ends; one of the radii may be zero."""
    split = _cylindrical(start, end)

    def field(p: Coordinates) -> Distances:
        height, radial, length = split(p)
        outline = [(-1.0, 0.0), (radius, 0.0), (end_radius, length), (-1.0, length)]
        return polygon_distance(radial, height, np.array(outline))

    return field


def torus(centre: Vector, axis: Vector, major: float, minor: float) -> Field:
    """Makes a torus: a tube of radius `minor` around the circle of radius `major` about `axis`."""
    split = _cylindrical(centre, np.asarray(centre, dtype=float) + np.asarray(axis, dtype=float))

    def field(p: Coordinates) -> Distances:
        height, radial, _ = split(p)
        return _norm(radial - major, height) - minor

    return field


def tube(knots: Float[np.ndarray, "k 3"], radii: Float[np.ndarray, " k"] | float) -> Field:
    """Makes a chain of capsules through the knots."""
    knots = np.asarray(knots, dtype=float)
    r = np.broadcast_to(np.asarray(radii, dtype=float), len(knots))
    links = [capsule(knots[i], knots[i + 1], r[i], r[i + 1]) for i in range(len(knots) - 1)]

    def field(p: Coordinates) -> Distances:
        distance = links[0](p)
        for link in links[1:]:
            np.minimum(distance, link(p), out=distance)
        return distance

    return field


def arc(centre: Vector, middle: Vector, side: Vector, radius: float, minor: float, half_angle: float) -> Field:
    """Makes a tube of radius `minor` along a circular arc that extends `half_angle` radians to both sides of `middle`.

    `middle` and `side` are orthogonal unit vectors that span the plane of the arc.
    """
    c, u, v = _column(centre), _column(middle), _column(side)
    w = np.cross(u[:, 0], v[:, 0]).reshape(3, 1)

    def field(p: Coordinates) -> Distances:
        q = p - c
        x, y, z = (u * q).sum(axis=0), (v * q).sum(axis=0), (w * q).sum(axis=0)
        angle = np.clip(np.arctan2(np.abs(y), x), 0, half_angle)
        return _norm(x - radius * np.cos(angle), np.abs(y) - radius * np.sin(angle), z) - minor

    return field


def halfspace(normal: Vector, offset: float) -> Field:
    """Makes the half-space `normal · x ≤ offset`, with the normal scaled to unit length."""
    n = np.asarray(normal, dtype=float)
    n = n / np.linalg.norm(n)
    return lambda p: n[0] * p[0] + n[1] * p[1] + n[2] * p[2] - offset


def polygon_distance(x: Distances, y: Distances, corners: Float[np.ndarray, "k 2"]) -> Distances:
    """Computes the signed distance to a simple polygon in 2D, from its nearest edge and the parity of crossings."""
    squared = np.full(np.shape(x), np.inf)
    inside = np.zeros(np.shape(x), dtype=bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        ex, ey = bx - ax, by - ay
        if ex == 0 and ey == 0:
            continue
        qx, qy = x - ax, y - ay
        t = np.clip((qx * ex + qy * ey) / (ex * ex + ey * ey), 0, 1)
        np.minimum(squared, (qx - t * ex) ** 2 + (qy - t * ey) ** 2, out=squared)
        if ey != 0:
            inside ^= ((ay > y) != (by > y)) & (qx < ex * (qy / ey))
    distance: Distances = np.where(inside, -1, 1) * np.sqrt(squared)
    return distance


def plate(
    corners: Float[np.ndarray, "k 2"], plane: tuple[int, int], level: float, thickness: float, rounding: float = 0.0
) -> Field:
    """Extrudes a polygon of two coordinates by `thickness` to both sides of `level` in the third.

    `rounding` rounds the edges inwards: the polygon is shrunk and then dilated, so its size is unchanged.
    """
    u, v = plane
    w = 3 - u - v
    outline = np.asarray(corners, dtype=float)

    def field(p: Coordinates) -> Distances:
        flat = polygon_distance(p[u], p[v], outline) + rounding
        across = np.abs(p[w] - level) - thickness + rounding
        corner = _norm(np.maximum(flat, 0), np.maximum(across, 0))
        distance: Distances = corner + np.minimum(np.maximum(flat, across), 0) - rounding
        return distance

    return field


def lathe(profile: Float[np.ndarray, "k 2"]) -> Field:
    """Makes a solid of revolution about z from its profile of points (r, z), which begins and ends on the axis.

    The profile is closed at r = -1, because an edge on the axis would be a zero inside the solid.
    """
    outline = np.asarray(profile, dtype=float)
    closed = np.vstack([[-1.0, outline[0, 1]], outline, [-1.0, outline[-1, 1]]])
    return lambda p: polygon_distance(_norm(p[0], p[1]), p[2], closed)
