"""Pairs centred and scaled to unit radius, the form that the solvers take."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from symjax.geometry.similarity import Similarity


class NormalisedPairs(NamedTuple):
    """Pairs centred and scaled to unit radius.

    Attributes:
        x: one end of every pair, scaled.
        y: the other end.
        weights: weights of the pairs, scaled to mean 1.
        to_given: similarity that maps the scaled pairs back to the units of the points.
    """

    x: Float[Array, "n 3"]
    y: Float[Array, "n 3"]
    weights: Float[Array, " n"]
    to_given: Similarity


MAX_COORDINATE = 1e3  # in radii: coordinates farther from the centre are clipped
NUM_SAMPLED = 128  # pairs that the centre and the radius are computed from
_GOLDEN_FRACTION = 0.6180339887498949  # fractional part of the golden ratio


def systematic_sample(weights: Float[Array, " n"], num: int) -> Int[Array, " num"]:
    """Draws `num` rows in proportion to the weights, by systematic sampling: one per stratum of the total weight.

    The sample is deterministic. The position within each stratum follows multiples of the golden ratio, so that it
    does not resonate with a periodic order of the pairs. If there are fewer than `num` pairs, rows are drawn more than
    once.
    """
    stratum = np.arange(num)
    cumulative = jnp.cumsum(weights)
    quantile = jnp.asarray((stratum + (stratum * _GOLDEN_FRACTION) % 1) / num, cumulative.dtype)
    # side="right" skips pairs of weight 0, which add nothing to the cumulative weight
    row = jnp.searchsorted(cumulative, quantile * cumulative[-1], side="right")
    return jnp.minimum(row, len(weights) - 1)


def normalise_pairs(x: Float[Array, "n 3"], y: Float[Array, "n 3"], weights: Float[Array, " n"]) -> NormalisedPairs:
    """Centres and scales pairs, so that the solvers work in any unit and about any origin.

    The centre is the median of a sample of the pairs, and the radius their median distance from it, so outliers have
    little effect on either. The fit does not depend on them, so their derivatives are stopped.
    """
    drawn = systematic_sample(jax.lax.stop_gradient(weights), NUM_SAMPLED)
    points = jax.lax.stop_gradient(jnp.concatenate([x[drawn], y[drawn]]))
    centre = jnp.median(points, axis=0)
    # the largest coordinate instead of the Euclidean length, whose squares overflow or underflow in extreme units
    distance = jnp.max(jnp.abs(points - centre[None, :]), axis=1)
    median = jnp.median(distance)
    radius = jnp.where(median > 0, median, jnp.max(distance))
    radius = jnp.where(radius > 0, radius, 1)
    # the centre is subtracted first: far from the origin the inverse of `to_given` has larger rounding errors.
    # clipped, because such a far pair has no weight, but the features, which are squares, would round f by more than σ²
    scaled = [jnp.clip((end - centre[None, :]) / radius, -MAX_COORDINATE, MAX_COORDINATE) for end in (x, y)]
    return NormalisedPairs(scaled[0], scaled[1], weights / jnp.mean(weights), Similarity(radius, None, centre))
