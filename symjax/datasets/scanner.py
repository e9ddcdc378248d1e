"""A simulated scan from one side: the points of a cloud that are visible from a viewpoint.

The method is hidden point removal (Katz, Tal and Basri, "Direct visibility of point sets", SIGGRAPH 2007). Each
point is flipped along its ray from the viewpoint to the outside of a large sphere. The visible points are those whose
flipped images lie on the convex hull of all flipped points and the viewpoint.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import ConvexHull

from symjax.errors import InvalidArgumentError, TooFewPointsError

DISTANCE = 2.0
"""Distance of a random viewpoint from the centroid, in diagonals of the cloud."""

FLIP_RADIUS = 10**2.5
"""Radius of the sphere divided by the largest distance from the viewpoint. A larger radius keeps more hidden points;
a smaller one drops more visible points."""


def scan(
    points: Float[np.ndarray, "n 3"],
    rng: int | np.random.Generator = 0,
    *,
    viewpoint: Float[np.ndarray, " 3"] | None = None,
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """Selects the points that are visible from one viewpoint, by hidden point removal.

    Args:
        points: a cloud.
        rng: seed or generator of the viewpoint; not used if `viewpoint` is given.
        viewpoint: position of the scanner; by default, a random point two diagonals from the centroid.

    Returns:
        The visible points, and their indices in `points`, ascending.

    Raises:
        TooFewPointsError: if there are fewer than four points.
        InvalidArgumentError: if the viewpoint is one of the points.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> ball = symjax.datasets.generate("ball", num_points=500).points
        >>> visible, index = symjax.datasets.scan(ball, viewpoint=np.array([0.0, 0.0, 4.0]))
        >>> print(f"mean height: {abs(ball[:, 2].mean()):.1f} of all points, {visible[:, 2].mean():.1f} of the visible")
        mean height: 0.0 of all points, 0.2 of the visible
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
        raise InvalidArgumentError(f"the viewpoint coincides with point {int(distance.argmin())}: choose another")
    flipped = ray + 2 * (FLIP_RADIUS * distance.max() - distance) * ray / distance
    hull = ConvexHull(np.vstack([flipped, np.zeros(3)]))
    seen = np.sort(hull.vertices[hull.vertices < len(points)])
    return points[seen], seen
