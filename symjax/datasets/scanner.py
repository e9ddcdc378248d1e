"""A one-sided scanner: the points of a cloud that are visible from a viewpoint.

Katz, Tal and Basri, "Direct visibility of point sets", SIGGRAPH 2007: each point is flipped on its ray from the
viewpoint, out to the far side of a large sphere; the visible points are those on the convex hull of the flipped
ones and the viewpoint.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull

from symjax.errors import InvalidArgumentError, TooFewPointsError

DISTANCE = 2.0
"""Distance of a random viewpoint from the centroid, in diagonals of the cloud."""

FLIP_RADIUS = 10**2.5
"""Radius of the sphere over the largest range. A larger one passes more points that are hidden, a smaller one
drops more that are visible."""


def scan(
    points: Float[np.ndarray, "n 3"],
    rng: int | np.random.Generator = 0,
    *,
    viewpoint: Float[np.ndarray, " 3"] | None = None,
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """The points that a scanner sees, and their indices.

    Args:
        points: A cloud.
        rng: Seed or generator of a random viewpoint, two diagonals from the centroid.
        viewpoint: Where the scanner stands; by default it is random.

    Raises:
        TooFewPointsError: There are fewer than four points.
        InvalidArgumentError: The viewpoint is one of the points.
    """
    if len(points) < 4:
        raise TooFewPointsError(f"a scan needs at least 4 points, got {len(points)}")
    if viewpoint is None:
        direction = np.random.default_rng(rng).normal(size=3)
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        viewpoint = points.mean(axis=0) + DISTANCE * diagonal * direction / np.linalg.norm(direction)
    ray = points - viewpoint
    distance = np.linalg.norm(ray, axis=1, keepdims=True)
    if distance.min() == 0:
        raise InvalidArgumentError(f"the viewpoint is point {int(distance.argmin())}: move it off the cloud")
    flipped = ray + 2 * (FLIP_RADIUS * distance.max() - distance) * ray / distance
    hull = ConvexHull(np.vstack([flipped, np.zeros(3)]))
    seen = np.sort(hull.vertices[hull.vertices < len(points)])
    return points[seen], seen
