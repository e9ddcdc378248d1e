"""A simulated scan from one side: the points of a cloud that are visible from a viewpoint.

The method is hidden point removal (Katz, Tal and Basri, "Direct visibility of point sets", SIGGRAPH 2007). Each
point is flipped along its ray from the viewpoint to the outside of a large sphere. The visible points are those whose
flipped images lie on the convex hull of all flipped points and the viewpoint.
"""

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, QhullError

from symjax.errors import DegenerateCloudError, InvalidArgumentError, TooFewPointsError
from symjax.geometry.point_arrays import as_finite_points
from symjax.geometry.seeds import Seed, seeded

DISTANCE = 2.0
"""Distance of a random viewpoint from the mean of the points, in diagonals of the cloud."""

FLIP_RADIUS = 10**2.5
"""Radius of the sphere divided by the largest distance from the viewpoint. A larger radius keeps more hidden points;
a smaller one drops more visible points."""


def scan(
    points: ArrayLike,
    rng: Seed = 0,
    *,
    viewpoint: ArrayLike | None = None,
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """Selects the points that are visible from one viewpoint, by hidden point removal.

    Args:
        points: a cloud, of shape (n, 3).
        rng: seed or generator of the viewpoint; not used if `viewpoint` is given.
        viewpoint: position of the scanner, three coordinates; by default, a random point two diagonals from the mean.

    Returns:
        The visible points, and their indices in `points`, ascending.

    Raises:
        InvalidPointsError: if `points` is not an (n, 3) array of finite real numbers.
        TooFewPointsError: if there are fewer than four points.
        InvalidArgumentError: if the viewpoint is one of the points or is not a position, or `rng` is not a valid seed.
        DegenerateCloudError: if the points and the viewpoint lie in one plane.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> ball = symjax.datasets.generate("ball", num_points=500).points
        >>> visible, index = symjax.datasets.scan(ball, viewpoint=np.array([0.0, 0.0, 4.0]))
        >>> print(f"mean height: {abs(ball[:, 2].mean()):.1f} of all points, {visible[:, 2].mean():.1f} of the visible")
        mean height: 0.0 of all points, 0.2 of the visible
    """
    points = as_finite_points(points)
    if len(points) < 4:
        raise TooFewPointsError(f"a scan needs at least 4 points, got {len(points)}")
    if viewpoint is None:
        direction = seeded(rng).generator.normal(size=3)
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        eye = points.mean(axis=0) + DISTANCE * diagonal * direction / np.linalg.norm(direction)
    else:
        eye = _position(viewpoint)
    ray = points - eye
    distance = np.linalg.norm(ray, axis=1, keepdims=True)
    if distance.min() == 0:
        raise InvalidArgumentError(f"the viewpoint coincides with point {int(distance.argmin())}: choose another")
    flipped = ray + 2 * (FLIP_RADIUS * distance.max() - distance) * ray / distance
    try:
        hull = ConvexHull(np.vstack([flipped, np.zeros(3)]))
    except QhullError as error:
        raise DegenerateCloudError("the points and the viewpoint lie in one plane: choose another viewpoint") from error
    seen = np.sort(hull.vertices[hull.vertices < len(points)])
    return points[seen], seen


def _position(viewpoint: ArrayLike) -> Float[np.ndarray, " 3"]:
    try:
        position = np.asarray(viewpoint, dtype=float)
    except (TypeError, ValueError) as error:
        raise InvalidArgumentError(f"the viewpoint must be three numbers, got {viewpoint!r}") from error
    if position.shape != (3,) or not np.isfinite(position).all():
        raise InvalidArgumentError(f"the viewpoint must be three finite numbers, got {viewpoint!r}")
    return position
