"""The corruptions of the paper: outliers, a missing part and noise.

Apply them to a posed cloud. The outliers fill a box along the coordinate axes, so an object in its own frame would
share its mirror plane with them.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from symjax.datasets.scanner import scan
from symjax.geometry.checks import flag, number
from symjax.geometry.point_arrays import as_finite_points
from symjax.geometry.seeds import Seed, seeded


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


def add_outliers(points: ArrayLike, alpha: float, rng: Seed = 0) -> Float[np.ndarray, "m 3"]:
    """Appends `int(alpha * n)` outliers, distributed uniformly in the axis-aligned bounding box of the points.

    Args:
        points: a cloud, of shape (n, 3).
        alpha: number of outliers per point, the paper's α.
        rng: seed or generator of the outliers.

    Returns:
        The points in their order, followed by the outliers.

    Raises:
        InvalidPointsError: if `points` is not an (n, 3) array of finite real numbers, or is empty.
        InvalidArgumentError: if alpha is not a number, at least 0, or `rng` is not a valid seed.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> symjax.datasets.add_outliers(np.eye(3), 2.0).shape
        (9, 3)
    """
    cloud, alpha = as_finite_points(points), number("alpha", alpha, least=0)
    outliers = seeded(rng).generator.uniform(cloud.min(axis=0), cloud.max(axis=0), (int(alpha * len(cloud)), 3))
    return np.vstack([cloud, outliers])


def remove_part(
    points: ArrayLike, gamma: float, rng: Seed = 0
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """Removes the `int(gamma * n)` points that are nearest to a randomly chosen point of the cloud.

    Args:
        points: a cloud, of shape (n, 3).
        gamma: fraction of the points to remove, the paper's γ; at least 0 and below 1.
        rng: seed or generator of the chosen point.

    Returns:
        The remaining points, and their indices in `points`, ascending.

    Raises:
        InvalidPointsError: if `points` is not an (n, 3) array of finite real numbers, or is empty.
        InvalidArgumentError: if gamma is not in [0, 1), or `rng` is not a valid seed.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> line = np.outer(np.arange(10.0), [1, 0, 0])
        >>> remaining, kept = symjax.datasets.remove_part(line, 0.4)
        >>> kept
        array([0, 1, 2, 3, 4, 5])
    """
    cloud, gamma = as_finite_points(points), number("gamma", gamma, least=0, below=1)
    centre = cloud[seeded(rng).generator.integers(len(cloud))]
    distance = np.linalg.norm(cloud - centre, axis=1)
    kept = np.sort(np.argsort(distance, kind="stable")[int(gamma * len(cloud)) :])
    return cloud[kept], kept


def add_noise(
    points: ArrayLike,
    level: float,
    rng: Seed = 0,
    *,
    diagonal: float | None = None,
) -> Float[np.ndarray, "n 3"]:
    """Adds independent Gaussian noise of standard deviation `level * diagonal` to every coordinate.

    Args:
        points: a cloud, of shape (n, 3).
        level: standard deviation of the noise as a fraction of the diagonal.
        rng: seed or generator of the noise.
        diagonal: length that `level` refers to, in the units of the points; by default, the diagonal of the
            axis-aligned bounding box of the points.

    Returns:
        The displaced points, in the order of `points`.

    Raises:
        InvalidPointsError: if `points` is not an (n, 3) array of finite real numbers, or is empty.
        InvalidArgumentError: if the level or the diagonal is not a number, at least 0, or `rng` is not a valid seed.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> noisy = symjax.datasets.add_noise(np.zeros((5000, 3)), 0.01, diagonal=2.0)
        >>> print(f"{noisy.std():.3f}")
        0.020
    """
    cloud, level = as_finite_points(points), number("level", level, least=0)
    deviation = level * _length(cloud, diagonal)
    return cloud + seeded(rng).generator.normal(scale=deviation, size=cloud.shape)


def corrupt(
    points: ArrayLike,
    rng: Seed = 0,
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
        points: a posed cloud, of shape (n, 3) (see `symjax.datasets.pose`).
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
        InvalidPointsError: if `points` is not an (n, 3) array of finite real numbers, or is empty.
        InvalidArgumentError: if an option has a wrong type or is out of its range, or `rng` is not a valid seed.
        TooFewPointsError: if `one_sided` is set and there are fewer than four points.

    Example:
        >>> import symjax
        >>> sample = symjax.datasets.pose(symjax.datasets.generate("mug", num_points=1000))
        >>> corrupted = symjax.datasets.corrupt(sample.points, outliers=0.5, missing=0.2, noise=0.01)
        >>> corrupted.points.shape  # 800 points remain; 400 outliers are added
        (1200, 3)
    """
    cloud, generator = as_finite_points(points), seeded(rng).generator
    missing = number("missing", missing, least=0, below=1)
    noise, outliers = number("noise", noise, least=0), number("outliers", outliers, least=0)
    diagonal = _length(cloud, diagonal)
    source = np.arange(len(cloud))
    if flag("one_sided", one_sided):
        cloud, kept = scan(cloud, generator)
        source = source[kept]
    if missing:
        cloud, kept = remove_part(cloud, missing, generator)
        source = source[kept]
    cloud = add_noise(cloud, noise, generator, diagonal=diagonal)
    cloud = add_outliers(cloud, outliers, generator)
    source = np.concatenate([source, np.full(len(cloud) - len(source), -1)])
    order = generator.permutation(len(cloud))
    return Corrupted(cloud[order], source[order])


def _length(points: Float[np.ndarray, "n 3"], diagonal: float | None) -> float:
    """Returns the given diagonal, or that of the axis-aligned bounding box of the points."""
    if diagonal is None:
        return float(np.linalg.norm(np.ptp(points, axis=0)))
    return number("diagonal", diagonal, least=0)
