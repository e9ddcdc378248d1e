"""Fits the best mirror plane of putative pairs, without a start."""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.geometry.checks import whole
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit import Fit, unscale
from symjax.l2e.jax_config import jit, keep_float64
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
"""Largest number of pairs in the first refinement, which is of all kept hypotheses; more pairs are sampled."""

FIRST_STEPS = 6
"""Steps of the first refinement. Correct hypotheses have converged by then, and the others do not need to."""


@jit(static_argnames=("num_hypotheses", "num_refined"))
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
    # refine all starts by a few steps on a sample of the pairs, then the best of them to convergence on all pairs
    sampled = features(*(sample_pairs(constant, NUM_SAMPLED) if len(pairs.x) > NUM_SAMPLED else constant[:3]))
    first = make_solver("newton", Criterion(sampled, constant_sigma), limits._replace(max_steps=FIRST_STEPS))
    refined = jax.vmap(partial(solve, first))(starts).point
    criterion = Criterion(features(*constant[:3], used=pairs.used), constant_sigma)
    values = jax.vmap(criterion.value)(refined)
    lowest = jnp.argmin(jnp.where(jnp.isfinite(values), values, jnp.inf))
    minimum = solve(make_solver("newton", criterion, limits), refined[lowest])
    return unscale(normalised, scaled, minimum, starts[lowest])


@keep_float64
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
    """Searches for the best mirror plane of putative pairs by the L2E estimator. It needs no start.

    Every pair proposes its own mirror plane as a hypothesis. The hypotheses are ranked by the criterion on a sample of
    the pairs, and near duplicates are dropped. The best ones are refined by a few Newton steps, on a sample if there
    are many pairs. The best of these is then refined to convergence on all pairs.

    The function is pure JAX and has the derivatives of `fit_plane`.

    Args:
        x: one end of every pair, in any unit.
        y: the other end, in the same unit.
        sigma: scale σ of the residual, in the units of the points, or "auto", see `fit_plane`.
        weights: nonnegative weights of the pairs, by default all 1.
        num_hypotheses: number of pairs that propose a plane. If a fraction ρ of the pairs are inliers, a fraction
            0.7 ρ of the hypotheses are correct.
        num_refined: number of distinct hypotheses that are refined. It has no effect if `sigma` is "auto".
        max_steps: limit on the steps of the last refinement.
        tol: tolerance of the gradient norm, see `fit_plane`.

    Returns:
        The fit of lowest loss. Its `num_steps` counts the steps of the last refinement, and its `start` is the
        hypothesis that it was refined from.

    Raises:
        SymjaxError: if an argument is invalid, see `fit_plane`.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.8)
        >>> fit = symjax.fit_global(pairs.x, pairs.y, 0.01)
        >>> print(pairs.normal.round(2), fit.plane.normal.round(2))
        [-0.29  0.92  0.26] [-0.29  0.92  0.26]
    """
    pairs = pad_pairs(x, y, weights)
    limits = checked_limits("newton", max_steps, tol, pairs.x.dtype)
    num_hypotheses = whole("num_hypotheses", num_hypotheses, 1)
    num_refined = whole("num_refined", num_refined, 1)
    scale = checked_sigma(sigma, "newton", pairs.x.dtype)
    return _fit_global(pairs, scale, limits, num_hypotheses=num_hypotheses, num_refined=num_refined)
