"""The paper's corruptions of a posed cloud, and noise.

They are meant for posed clouds: the box of outliers is along the coordinate axes, and an object that is still
in its own frame shares its symmetry with the box.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.datasets.scanner import scan
from symjax.errors import InvalidArgumentError


class Corrupted(NamedTuple):
    """Points after corruption, and the index of each in the cloud it came from: -1 for an outlier."""

    points: Float[np.ndarray, "m 3"]
    source: Int[np.ndarray, " m"]


def add_outliers(
    points: Float[np.ndarray, "n 3"], alpha: float, rng: int | np.random.Generator = 0
) -> Float[np.ndarray, "m 3"]:
    """The points followed by `int(alpha n)` outliers, uniform in their axis-aligned bounding box.

    Raises:
        InvalidArgumentError: alpha is negative.
    """
    if not alpha >= 0:
        raise InvalidArgumentError(f"alpha is outliers per point and must not be negative, got {alpha}")
    rng = np.random.default_rng(rng)
    outliers = rng.uniform(points.min(axis=0), points.max(axis=0), (int(alpha * len(points)), 3))
    return np.vstack([points, outliers])


def remove_part(
    points: Float[np.ndarray, "n 3"], gamma: float, rng: int | np.random.Generator = 0
) -> tuple[Float[np.ndarray, "m 3"], Int[np.ndarray, " m"]]:
    """The cloud without the `int(gamma n)` points nearest to a random one of them; also the indices kept.

    Raises:
        InvalidArgumentError: gamma is not in [0, 1).
    """
    if not 0 <= gamma < 1:
        raise InvalidArgumentError(f"gamma is the share removed and must be in [0, 1), got {gamma}")
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
    """The points with normal noise of standard deviation `level` times the diagonal in each coordinate.

    Args:
        points: A cloud.
        level: Standard deviation as a fraction of the diagonal.
        rng: Seed or generator.
        diagonal: Length to which the level refers; by default the diagonal of the points' bounding box.

    Raises:
        InvalidArgumentError: The level is negative.
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
    """A posed cloud seen from one side, cut, made noisy, strewn with outliers and shuffled, in this order.

    Args:
        points: A posed cloud.
        rng: Seed or generator.
        outliers: Outliers per remaining point, the paper's α.
        missing: Share of the points cut away as one part, the paper's γ.
        noise: Standard deviation of the noise as a fraction of the diagonal.
        one_sided: Keep only what a scanner at a random viewpoint sees.
        diagonal: Length to which `noise` refers; by default the diagonal of the whole cloud's bounding box.

    Raises:
        InvalidArgumentError: A share is out of its range.
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
