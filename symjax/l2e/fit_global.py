"""The best mirror plane of putative pairs, with no start."""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.geometry.checks import whole
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit import Fit, unscale
from symjax.l2e.jax_config import float64_as_given
from symjax.l2e.pairs.arguments import Points, Sigma, Weights, checked_sigma
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs
from symjax.l2e.solvers.base import Limits, solve
from symjax.l2e.solvers.registry import MAX_STEPS, checked_limits, make_solver
from symjax.l2e.starts.hypotheses import (
    NUM_HYPOTHESES,
    NUM_KEPT,
    pair_hypotheses,
    rank_hypotheses,
    sample_pairs,
)
from symjax.l2e.starts.scale_estimation import estimate_scale, starts_at_all_scales, unscale_with_sigma

NUM_SAMPLED = 1024
"""Pairs that the planes are refined on, if there are more, before one of them is chosen."""

FIRST_STEPS = 6
"""Steps that are taken there: right hypotheses have converged by then, and the others need not."""


@partial(jax.jit, static_argnames=("num_hypotheses", "num_refined"))
def _fit_global(
    pairs: PaddedPairs, sigma: Float[Array, ""] | None, limits: Limits, *, num_hypotheses: int, num_refined: int
) -> Fit:
    normalised = normalise_pairs(pairs.x, pairs.y, pairs.weights)
    constant = jax.lax.stop_gradient(normalised)
    proposed = pair_hypotheses(constant, num_hypotheses)
    if sigma is None:
        starts = starts_at_all_scales(proposed, constant)
        return unscale_with_sigma(normalised, *estimate_scale(starts, constant, limits))
    scaled = sigma / normalised.to_given.scale
    constant_sigma = jax.lax.stop_gradient(scaled)
    starts = rank_hypotheses(proposed, constant, constant_sigma, num=num_refined)
    # a few steps of all on some of the pairs, and the best of them to its end on all
    few = features(*(sample_pairs(constant, NUM_SAMPLED) if len(pairs.x) > NUM_SAMPLED else constant[:3]))
    first = make_solver("newton", Criterion(few, constant_sigma), limits._replace(max_steps=FIRST_STEPS))
    near = jax.vmap(partial(solve, first))(starts).point
    criterion = Criterion(features(*constant[:3], used=pairs.used), constant_sigma)
    values = jax.vmap(criterion.value)(near)
    lowest = jnp.argmin(jnp.where(jnp.isfinite(values), values, jnp.inf))
    minimum = solve(make_solver("newton", criterion, limits), near[lowest])
    return unscale(normalised, scaled, minimum, starts[lowest])


@float64_as_given
def fit_global(
    x: Points,
    y: Points,
    sigma: Sigma,
    *,
    weights: Weights | None = None,
    num_hypotheses: int = NUM_HYPOTHESES,
    num_refined: int = NUM_KEPT,
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """Fits the best mirror plane of putative pairs by the L2E estimator: no start is needed.

    Every pair is a hypothesis (its own mirror plane). All are ranked by the criterion on a sample of the pairs, without
    near duplicates; the best few are refined by a few steps of Newton's method, on a sample where there are many
    pairs; and the best of those is refined to its end on all. Pure JAX, with the derivatives of `fit_plane`.

    Args:
        x: one end of every pair.
        y: the other end.
        sigma: see `fit_plane`.
        weights: nonnegative weights of the pairs.
        num_hypotheses: how many pairs propose their plane. With a share ρ of mirror pairs, 0.7 ρ of them are right.
        num_refined: how many distinct planes are refined, at a given σ.
        max_steps: limit on the steps of each.
        tol: bound on the gradient, see `fit_plane`.

    Returns:
        The fit of lowest loss; `num_steps` are its last ones, on all pairs, and `start` is its hypothesis.

    Raises:
        SymjaxError: see `fit_plane`.
    """
    pairs = pad_pairs(x, y, weights)
    limits = checked_limits("newton", max_steps, tol, pairs.x.dtype)
    num_hypotheses = whole("num_hypotheses", num_hypotheses, 1)
    num_refined = whole("num_refined", num_refined, 1)
    scale = checked_sigma(sigma, "newton", pairs.x.dtype)
    return _fit_global(pairs, scale, limits, num_hypotheses=num_hypotheses, num_refined=num_refined)
