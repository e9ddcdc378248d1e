"""A sweep of planted pairs from random starts: what `speed_sweep` times, and a process of its own on two devices."""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from symjax.datasets.planted_pairs import PlantedPairs, planted_pairs
from symjax.l2e.fit import Fit
from symjax.l2e.manifolds import random_points
from symjax.l2e.sweep import sweep

OUTLIERS = 0.8


def planted(num_pairs: int, seed: int) -> PlantedPairs:
    """The pairs."""
    return planted_pairs(np.random.default_rng(seed), num_pairs, OUTLIERS)


def random_starts(
    num_pairs: int, sigmas: Float[np.ndarray, "S"], restarts: int, seed: int, **options: Any
) -> Callable[[], Fit]:
    """A sweep of random starts, ready to run."""
    pairs = planted(num_pairs, seed)
    x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)
    return partial(sweep, x, y, sigmas, random_points(jax.random.key(seed), restarts), **options)
