"""Planted pairs, and the planes that the paper's estimators fit to them; shared by three studies."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

import symjax
from symjax.datasets.planted_pairs import PlantedPairs, planted_pairs
from symjax.geometry import distance
from symjax.geometry.arrays import AnyArray
from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane
from symjax.l2e.starts import initialisation

AWAY = 1.5
"""Distance of the outliers' centre from the blob's centre if they lie "beside" it, in radii of the blob."""

PLACES = ("within", "beside")
"""Where outlier pairs lie: within the blob, or beside it."""

METHODS = ("L2E, RGA start", "L2E, 64 starts", "L2", "L2 as printed")
"""Names of the estimators that `planes` runs."""


def pairs(seed: list[int], num_pairs: int, outliers: float, blob: str, place: str = "within") -> PlantedPairs:
    """Generates planted pairs with outlier pairs within the blob, or beside it as clutter in a random direction.

    For one seed, more outliers change neither the pose nor the mirror pairs that remain. Outliers within the blob are
    symmetric about its mirror plane on average: they add variance to least squares, but no bias. Clutter adds bias.

    Args:
        seed: seed of the pairs, a list as for `numpy.random.default_rng`.
        num_pairs: number of pairs.
        outliers: share of the pairs that are outliers, 0 to 1.
        blob: shape of the blob: "isotropic", "thin" or "wide".
        place: one of `PLACES`.
    """
    pool = planted_pairs(np.random.default_rng(seed), 2 * num_pairs, 0.0, blob)
    x, y = pool.x[:num_pairs], pool.y[:num_pairs]
    inlier = np.arange(num_pairs) >= round(outliers * num_pairs)
    y = np.where(inlier[:, None], y, pool.x[num_pairs:])
    if place == "beside":
        direction = np.random.default_rng([*seed, 1]).normal(size=3)
        shift = AWAY * direction / np.linalg.norm(direction) * ~inlier[:, None]
        x, y = x + shift, y + shift
    return PlantedPairs(x, y, pool.normal, pool.offset, inlier)


def planes(x: Float[AnyArray, "n 3"], y: Float[AnyArray, "n 3"], sigma: float, restarts: int = 64) -> dict[str, Plane]:
    """Fits a plane to the pairs by each of `METHODS`. Call it under `jax.enable_x64(True)` for float64."""
    x, y = jnp.asarray(x), jnp.asarray(y)
    swept = symjax.best(symjax.sweep(x, y, [sigma], fibonacci(restarts))).plane
    found = (
        symjax.fit_plane(x, y, sigma).plane,
        Plane(swept.normal[0], swept.offset[0]),
        initialisation.l2_plane(x, y),
        initialisation.l2_plane(x, y, as_printed=True),
    )
    return {
        method: Plane(np.asarray(plane.normal), np.asarray(plane.offset))
        for method, plane in zip(METHODS, found, strict=True)
    }


def angle(plane: Plane, truth: PlantedPairs) -> float:
    """Returns the angle between a plane and the planted one, in degrees."""
    return float(distance.deviation_angle(plane.normal, truth.normal))
