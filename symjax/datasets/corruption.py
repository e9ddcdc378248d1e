"""The corruptions of the paper: outliers, a missing part and noise.

Apply them to a posed cloud. The outliers fill a box along the coordinate axes, so an object in its own frame would
share its mirror plane with them.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.datasets.scanner import scan
from symjax.errors import InvalidArgumentError


class Corrupted(NamedTuple):
    """A corrupted cloud, and where each of its points comes from.

    Attributes:
        points: the corrupted cloud.
        source: index of each point in the original cloud; -1 for an outlier.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> points = np.random.default_rng(0).normal(size=(100, 3))
        >>> corrupted = symjax.datasets.corrupt(points, outliers=0.5)
        >>> corrupted.points.shape, int((corrupted.source == -1).sum())
        ((150, 3), 50)
    """

    points: Float[np.ndarray, "m 3"]
    source: Int[np.ndarray, " m"]


def add_outliers(
    points: Float[np.ndarray, "n 3"], alpha: float, rng: int | np.random.Generator = 0
) -> Float[np.ndarray, "m 3"]:
    """Appends `int(alpha * n)` outliers, distributed uniformly in the axis-aligned bounding box of the points.

    Args:
        points: a cloud.
        alpha: number of outliers per point, the paper's α.
        rng: seed or generator of the outliers.

    Returns:
        The points in their order, followed by the outliers.

    Raises:
        InvalidArgumentError: if alpha is negative.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> symjax.datasets.add_outliers(np.eye(3), 2.0).shape
        (9, 3)
    """
    if not alpha >= 0:
        raise InvalidArgumentError(f"alpha must not be negative, got {alpha}: pass the number of outliers per point")
    rng = np.random.default_rng(rng)
    outliers = rng.uniform(points.min(axis=0), points.max(axis=0), (int(alpha * len(points)), 3))
    return np.vstack([points, outliers])


def remove_part(
    points: Float[np.ndarray, "n 3"], gamma: float, rng: int | np.random.Generator = 0
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """Removes the `int(gamma * n)` points that are nearest to a randomly chosen point of the cloud.

    Args:
        points: a cloud.
        gamma: fraction of the points to remove, the paper's γ; at least 0 and below 1.
        rng: seed or generator of the chosen point.

    Returns:
        The remaining points, and their indices in `points`, ascending.

    Raises:
        InvalidArgumentError: if gamma is not in [0, 1).

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> line = np.outer(np.arange(10.0), [1, 0, 0])
        >>> remaining, kept = symjax.datasets.remove_part(line, 0.4)
        >>> kept
        array([0, 1, 2, 3, 4, 5])
    """
    if not 0 <= gamma < 1:
        raise InvalidArgumentError(f"gamma must be in [0, 1), got {gamma}: pass the fraction of the points to remove")
    rng = np.random.default_rng(rng)
    centre = points[rng.integers(len(points))]
    distance = np.linalg.norm(points - centre, axis=1)
    kept = np.sort(np.argsort(distance, kind="stable")[int(gamma * len(points)) :])
    return points[kept], kept


def add_noise(
    points: Float[np.ndarray, "n 3"],
    level: float,
    rng: int | np.random.Generator = 0,
    *,
    diagonal: float | None = None,
) -> Float[np.ndarray, "n 3"]:
    """Adds independent Gaussian noise of standard deviation `level * diagonal` to every coordinate.

    Args:
        points: a cloud.
        level: standard deviation of the noise as a fraction of the diagonal.
        rng: seed or generator of the noise.
        diagonal: length that `level` refers to, in the units of the points; by default, the diagonal of the
            axis-aligned bounding box of the points.

    Returns:
        The displaced points, in the order of `points`.

    Raises:
        InvalidArgumentError: if the level is negative.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> noisy = symjax.datasets.add_noise(np.zeros((5000, 3)), 0.01, diagonal=2.0)
        >>> print(f"{noisy.std():.3f}")
        0.020
    """
    if not level >= 0:
        raise InvalidArgumentError(f"the noise level must not be negative, got {level}")
    rng = np.random.default_rng(rng)
    if diagonal is None:
        diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    return points + rng.normal(scale=level * diagonal, size=points.shape)


def corrupt(
    points: Float[np.ndarray, "n 3"],
    rng: int | np.random.Generator = 0,
    *,
    outliers: float = 0.0,
    missing: float = 0.0,
    noise: float = 0.0,
    one_sided: bool = False,
    diagonal: float | None = None,
) -> Corrupted:
    """Makes a posed cloud look like a scan, and shuffles it.

    The corruptions are applied in this order: a scan from one side, a missing part, noise, outliers.

    Args:
        points: a posed cloud (see `symjax.datasets.pose`).
        rng: seed or generator of all corruptions.
        outliers: number of outliers per remaining point, the paper's α.
        missing: fraction of the points to remove as one part, the paper's γ.
        noise: standard deviation of the noise in each coordinate, as a fraction of the diagonal.
        one_sided: whether to keep only the points that are visible from a random viewpoint.
        diagonal: length that `noise` refers to, in the units of the points; by default, the diagonal of the
            axis-aligned bounding box of the whole cloud.

    Returns:
        The corrupted points, and the index of each in `points`.

    Raises:
        InvalidArgumentError: if `outliers` or `noise` is negative, or `missing` is not in [0, 1).
        TooFewPointsError: if `one_sided` is set and there are fewer than four points.

    Example:
        >>> import symjax
        >>> sample = symjax.datasets.pose(symjax.datasets.generate("mug", num_points=1000))
        >>> corrupted = symjax.datasets.corrupt(sample.points, outliers=0.5, missing=0.2, noise=0.01)
        >>> corrupted.points.shape  # 800 points remain; 400 outliers are added
        (1200, 3)
    """
    rng = np.random.default_rng(rng)
    if diagonal is None:
        diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    source = np.arange(len(points))
    if one_sided:
        points, kept = scan(points, rng)
        source = source[kept]
    if missing:
        points, kept = remove_part(points, missing, rng)
        source = source[kept]
    points = add_noise(points, noise, rng, diagonal=diagonal)
    points = add_outliers(points, outliers, rng)
    source = np.concatenate([source, np.full(len(points) - len(source), -1)])
    order = rng.permutation(len(points))
    return Corrupted(points[order], source[order])
