"""Planted pairs and the planes that the paper's estimators make of them: what three experiments share."""

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
"""Distance, in radii of the blob, at which the centre of outliers "beside" it stands."""

PLACES = ("within", "beside")

METHODS = ("L2E, RGA start", "L2E, 64 starts", "L2", "L2 as printed")


def pairs(seed: list[int], num_pairs: int, outliers: float, blob: str, place: str = "within") -> PlantedPairs:
    """Planted pairs whose outliers lie within the blob, or "beside" it as clutter in a random direction.

    With one seed and more outliers the pose and the remaining mirror pairs stay. Outliers within the blob are symmetric
    about its mirror on average, so they shake the least squares but do not pull it to a side; clutter does.
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
    """The plane of every one of `METHODS`. Call it under `jax.enable_x64(True)` for float64."""
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
    """Degrees between a plane and the planted one."""
    return float(distance.deviation_angle(plane.normal, truth.normal))
