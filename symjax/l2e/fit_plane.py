"""Fits the mirror plane of putative pairs from one start."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Real

from symjax.geometry.arrays import AnyArray
from symjax.geometry.checks import choice
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit import Fit, unscale
from symjax.l2e.jax_config import jit, keep_float64
from symjax.l2e.manifolds import normalise
from symjax.l2e.pairs.arguments import Points, Sigma, Weights, checked_normals, checked_sigma
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs
from symjax.l2e.solvers.base import Limits, solve
from symjax.l2e.solvers.names import AnySolver
from symjax.l2e.solvers.registry import MAX_STEPS, checked_limits, make_solver
from symjax.l2e.starts.hypotheses import offset_search
from symjax.l2e.starts.initialisation import NORMALS
from symjax.l2e.starts.scale_estimation import SIGMA_GRID, estimate_scale, unscale_with_sigma


@jit(static_argnames=("solver", "start"))
def _fit_plane(
    pairs: PaddedPairs,
    sigma: Float[Array, ""] | None,
    v0: Float[Array, " 3"] | None,
    limits: Limits,
    *,
    solver: AnySolver,
    start: str,
) -> Fit:
    normalised = normalise_pairs(pairs.x, pairs.y, pairs.weights)
    constant = jax.lax.stop_gradient(normalised)
    if v0 is None:
        v0 = NORMALS[start](constant.x, constant.y, weights=constant.weights)
    v0 = normalise(jax.lax.stop_gradient(v0))
    plane_at = offset_search(constant)
    if sigma is None:
        grid = jnp.asarray(SIGMA_GRID, v0.dtype)
        starts = jax.vmap(lambda sigma: jnp.append(plane_at(v0, sigma), jnp.log(sigma)))(grid)
        return unscale_with_sigma(normalised, *estimate_scale(starts, constant, limits))
    scaled = sigma / normalised.to_given.scale
    constant_sigma = jax.lax.stop_gradient(scaled)
    criterion = Criterion(features(*constant[:3], used=pairs.used), constant_sigma)
    point = plane_at(v0, constant_sigma)
    return unscale(normalised, scaled, solve(make_solver(solver, criterion, limits), point), point)


@keep_float64
def fit_plane(
    x: Points,
    y: Points,
    sigma: Sigma,
    v0: Real[AnyArray, " 3"] | Sequence[float] | str | None = None,
    *,
    weights: Weights | None = None,
    solver: AnySolver = "newton",
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """Fits the mirror plane of putative pairs by the L2E estimator (paper, Eq. 5), from one start.

    The criterion has many local optima, and one start leads to a nearby one. `fit_global` searches for the best
    plane, and `sweep` tries many starts.

    The function is pure JAX: jit, vmap and grad apply to it. By the implicit function theorem the fit has forward and
    reverse derivatives in x, y, weights and sigma. It has none in v0.

    float64 NumPy arrays and lists are fitted in float64 regardless of JAX's flags. JAX arrays and traced arguments
    keep their own type.

    Args:
        x: one end of every pair, in any unit.
        y: the other end, in the same unit: y[i] is the putative mirror image of x[i].
        sigma: scale σ of the residual, in the units of the points. "auto" estimates it together with the inlier
            fraction (`symjax.l2e.starts.scale_estimation`).
        v0: unit normal to start from, or the name of a start: "rga" (the default), the robust Grassmann average of the
            mid-points; "pca", their least principal direction; "l2", the least-squares plane (Eq. 2, corrected).
        weights: nonnegative weights of the pairs, by default all 1. A boolean mask selects pairs.
        solver: "newton", trust-region Newton; "irls", iteratively reweighted least squares; "rbfgs", Riemannian BFGS
            on S² × R; "alternating", Algorithm 1 of the paper, the slowest; or an optimistix minimiser, such as
            `optimistix.BFGS(rtol=1e-8, atol=1e-8)` (`symjax.l2e.solvers.external`).
        max_steps: limit on the steps. For the alternating solver and optimistix minimisers, limit on the rounds.
        tol: tolerance of the gradient norm, see `Fit.grad_norm`. The default is eps^(2/3) of the points' type
            (eps^(1/2) for the alternating solver, eps^(2/5) for an optimistix minimiser).

    Returns:
        The fit. A solver that fails raises no error: read `fit.converged`, and `fit.message` for the reason.

    Raises:
        SymjaxError: if an argument is invalid, before anything is computed. The values of traced arguments are not
            checked.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.4)
        >>> fit = symjax.fit_plane(pairs.x, pairs.y, 0.01)
        >>> print(pairs.normal.round(2), fit.plane.normal.round(2))
        [-0.33 -0.27  0.91] [-0.33 -0.27  0.9 ]
    """
    pairs = pad_pairs(x, y, weights)
    limits = checked_limits(solver, max_steps, tol, pairs.x.dtype)
    scale = checked_sigma(sigma, solver, pairs.x.dtype)
    start = v0 if isinstance(v0, str) else "rga"
    choice("v0", start, NORMALS)
    normal = None if v0 is None or isinstance(v0, str) else checked_normals(v0, 1, pairs.x.dtype)
    return _fit_plane(pairs, scale, normal, limits, solver=solver, start=start)
