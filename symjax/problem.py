"""The pairs as the solver sees them."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.initial import median_point, weighted_quantile


class Problem(NamedTuple):
    """Pairs centred and scaled to unit radius.

    Attributes:
        x: one end of every pair, scaled.
        y: the other end.
        weights: the pairs' weights, of mean 1.
        centre: what was subtracted, in the units of the points.
        radius: what was divided by.
    """

    x: Float[Array, "n 3"]
    y: Float[Array, "n 3"]
    weights: Float[Array, "n"]
    centre: Float[Array, "3"]
    radius: Float[Array, ""]


def normalised(x: Float[Array, "n 3"], y: Float[Array, "n 3"], weights: Float[Array, "n"]) -> Problem:
    """Centres and scales pairs, so that any unit and any origin will do.

    The centre is the median and the radius the median distance from it, so that outliers move neither. The
    answer does not depend on them, so their derivatives are stopped.
    """
    points, twice = jnp.concatenate([x, y]), jnp.concatenate([weights, weights])
    points, twice = jax.lax.stop_gradient((points, twice))
    centre = median_point(points, twice)
    # the largest coordinate, not the Euclidean length: squares of very large or small lengths overflow
    distance = jnp.max(jnp.abs(points - centre[None, :]), axis=1)
    median = weighted_quantile(distance, jnp.asarray([0.5], x.dtype), twice)[0]
    radius = jnp.where(median > 0, median, jnp.max(distance))
    radius = jnp.where(radius > 0, radius, 1)
    scaled = [(end - centre[None, :]) / radius for end in (x, y)]
    return Problem(scaled[0], scaled[1], weights / jnp.mean(weights), centre, radius)
