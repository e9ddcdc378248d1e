"""Pairs centred and scaled to unit radius: what the solvers see."""

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
        weights: the pairs' weights, of mean 1.
        to_given: the way back to the units of the points: times the radius, and moved to the centre.
    """

    x: Float[Array, "n 3"]
    y: Float[Array, "n 3"]
    weights: Float[Array, " n"]
    to_given: Similarity


REACH = 1e3  # radii from the centre beyond which a coordinate is cut
NUM_SAMPLED = 128  # pairs that the centre and the radius are taken from
_FRACTION = 0.6180339887498949  # of the golden ratio


def systematic_sample(weights: Float[Array, " n"], num: int) -> Int[Array, " num"]:
    """Rows of `num` pairs, each drawn with its weight as probability: one from every num-th of the total weight.

    Nothing is random: the place within each share follows the golden ratio, which no order of the pairs has as its
    period. Of fewer pairs than `num` all are drawn, some more than once.
    """
    step = np.arange(num)
    mass = jnp.cumsum(weights)
    share = jnp.asarray((step + (step * _FRACTION) % 1) / num, mass.dtype)
    # from the right: a pair of weight 0 adds no mass, and is passed over
    row = jnp.searchsorted(mass, share * mass[-1], side="right")
    return jnp.minimum(row, len(weights) - 1)


def normalise_pairs(x: Float[Array, "n 3"], y: Float[Array, "n 3"], weights: Float[Array, " n"]) -> NormalisedPairs:
    """Centres and scales pairs, so that any unit and any origin will do.

    The centre is the median and the radius the median distance from it, of some of the pairs, so that outliers move
    neither. The answer does not depend on them, so their derivatives are stopped.
    """
    drawn = systematic_sample(jax.lax.stop_gradient(weights), NUM_SAMPLED)
    points = jax.lax.stop_gradient(jnp.concatenate([x[drawn], y[drawn]]))
    centre = jnp.median(points, axis=0)
    # the largest coordinate, not the Euclidean length: squares of very large or small lengths overflow
    distance = jnp.max(jnp.abs(points - centre[None, :]), axis=1)
    median = jnp.median(distance)
    radius = jnp.where(median > 0, median, jnp.max(distance))
    radius = jnp.where(radius > 0, radius, 1)
    # subtracted first: far from the origin the inverse of `to_given` would round by more. Cut, since farther off no
    # pair has a weight, but its f would be rounded by more than σ²: the features are its squares
    scaled = [jnp.clip((end - centre[None, :]) / radius, -REACH, REACH) for end in (x, y)]
    return NormalisedPairs(scaled[0], scaled[1], weights / jnp.mean(weights), Similarity(radius, None, centre))
