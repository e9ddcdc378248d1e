"""The mirror plane of putative pairs: from one start, or the best of all."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float

from symjax.errors import InvalidArgumentError
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit import Fit
from symjax.l2e.manifolds import normalise
from symjax.l2e.pairs.arguments import checked_name, checked_normals, checked_sigmas
from symjax.l2e.pairs.normalized import Problem, normalised
from symjax.l2e.pairs.padded import Pairs, given_pairs
from symjax.l2e.pairs.unscale import answered
from symjax.l2e.solvers.base import Limits, solve
from symjax.l2e.solvers.line_search import LINE_SEARCHES
from symjax.l2e.solvers.registry import SOLVERS, default_tol
from symjax.l2e.starts.hypotheses import HYPOTHESES, KEPT, drawn, hypotheses, lift, screened
from symjax.l2e.starts.initialization import NORMALS
from symjax.l2e.starts.scale_estimation import GRID, answered_with_scale, estimate, starts_at_all_scales

MAX_STEPS = 200
AUTO = "auto"

SAMPLE = 1024
"""Pairs that `fit_global` polishes its planes on, if there are more, before it chooses one."""

FIRST_STEPS = 6
"""Steps that it takes there: right hypotheses have converged by then, and the others need not."""

Sigma = Float[ArrayLike, ""] | str


def checked_limits(solver: str, line_search: str, max_steps: int, tol: float | None, dtype: Any) -> Limits:
    """The options that every solver has.

    Raises:
        InvalidArgumentError: for an unknown solver or line search, a negative limit, or a tolerance not above 0.
    """
    checked_name("solver", solver, SOLVERS)
    checked_name("line_search", line_search, LINE_SEARCHES)
    if max_steps < 0:
        raise InvalidArgumentError(f"max_steps must be 0 or more, not {max_steps}")
    tol = default_tol(solver, dtype) if tol is None else tol
    if not tol > 0:
        raise InvalidArgumentError(f"tol must be positive, not {tol}")
    # NumPy until a compiled function takes them, as in `given_pairs`
    known: Any = np.asarray(max_steps), np.asarray(tol, dtype)
    return Limits(*known)


def _checked_sigma(sigma: Any, solver: str, dtype: Any) -> Float[Array, ""] | None:
    """σ; None for "auto"."""
    if isinstance(sigma, str):
        if sigma != AUTO:
            raise InvalidArgumentError(f"sigma must be a positive number or {AUTO!r}, not {sigma!r}")
        if solver != "newton":
            raise InvalidArgumentError(f"sigma={AUTO!r} is estimated with solver='newton', not {solver!r}")
        return None
    return checked_sigmas(sigma, 0, dtype)


def _problem(pairs: Pairs) -> Problem:
    return normalised(pairs.x, pairs.y, pairs.weights)


@partial(jax.jit, static_argnames=("solver", "line_search", "start"))
def _fit_plane(
    pairs: Pairs,
    sigma: Float[Array, ""] | None,
    v0: Float[Array, "3"] | None,
    limits: Limits,
    *,
    solver: str,
    line_search: str,
    start: str,
) -> Fit:
    problem = _problem(pairs)
    constant = jax.lax.stop_gradient(problem)
    if v0 is None:
        v0 = NORMALS[start](constant.x, constant.y, weights=constant.weights)
    v0 = normalise(jax.lax.stop_gradient(v0))
    if sigma is None:
        grid = jnp.asarray(GRID, v0.dtype)
        starts = jax.vmap(lambda sigma: jnp.append(lift(constant)(v0, sigma), jnp.log(sigma)))(grid)
        return answered_with_scale(problem, estimate(starts, constant, limits))
    scaled = sigma / problem.radius
    constant_sigma = jax.lax.stop_gradient(scaled)
    criterion = Criterion(features(*constant[:3], used=pairs.used), constant_sigma)
    minimum = solve(SOLVERS[solver](criterion, limits, line_search), lift(constant)(v0, constant_sigma))
    return answered(problem, scaled, minimum)


@partial(jax.jit, static_argnames=("num_hypotheses", "num_polished"))
def _fit_global(
    pairs: Pairs, sigma: Float[Array, ""] | None, limits: Limits, *, num_hypotheses: int, num_polished: int
) -> Fit:
    problem = _problem(pairs)
    constant = jax.lax.stop_gradient(problem)
    proposed = hypotheses(constant, num_hypotheses)
    if sigma is None:
        return answered_with_scale(problem, estimate(starts_at_all_scales(proposed, constant), constant, limits))
    scaled = sigma / problem.radius
    constant_sigma = jax.lax.stop_gradient(scaled)
    starts = screened(proposed, constant, constant_sigma, num=num_polished)
    # a few steps of all on some of the pairs, and the best of them to its end on all
    few = features(*(drawn(constant, SAMPLE) if len(pairs.x) > SAMPLE else constant[:3]))
    first = SOLVERS["newton"](Criterion(few, constant_sigma), limits._replace(max_steps=FIRST_STEPS), "")
    near = jax.vmap(partial(solve, first))(starts).point
    criterion = Criterion(features(*constant[:3], used=pairs.used), constant_sigma)
    lowest = jnp.argmin(_finite(jax.vmap(criterion.value)(near)))
    return answered(problem, scaled, solve(SOLVERS["newton"](criterion, limits, ""), near[lowest]))


def _finite(values: Float[Array, "k"]) -> Float[Array, "k"]:
    return jnp.where(jnp.isfinite(values), values, jnp.inf)


def fit_plane(
    x: Float[ArrayLike, "n 3"],
    y: Float[ArrayLike, "n 3"],
    sigma: Sigma,
    v0: Float[ArrayLike, "3"] | str | None = None,
    *,
    weights: Float[ArrayLike, "n"] | None = None,
    solver: str = "newton",
    line_search: str = "armijo",
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """Fits the mirror plane of putative pairs by the L2E estimator (paper, Eq. 5), from one start.

    Pure JAX: it goes through jit, vmap and grad. The answer has derivatives in x, y, weights and sigma,
    forward and reverse, by the implicit function theorem; none in v0. The criterion has many local optima:
    from one start this finds the nearest; `fit_global` looks for the best, and `sweep` tries many starts.

    Args:
        x: one end of every pair.
        y: the other end; y[i] is the putative mirror image of x[i].
        sigma: scale σ of the residual, in the units of the points; "auto" estimates it together with the share of
            mirror pairs (`symjax.l2e.starts.scale_estimation`).
        v0: unit normal to start from, or a start by name: "rga" (or None), the robust Grassmann average of the
            mid-points; "pca", their least principal direction; "l2", the least-squares plane (Eq. 2, corrected).
        weights: nonnegative weights of the pairs.
        solver: "newton", trust-region Newton; "mm", reweighted least squares; "joint", Riemannian BFGS on S² × R;
            or "alternating", Algorithm 1 of the paper, slowest.
        line_search: of the last two solvers: "armijo" or "wolfe" (strong).
        max_steps: limit on the steps, or on the rounds of the alternating solver.
        tol: bound on the gradient, see `Fit.grad_norm`; None is eps^(2/3) of the points' type
            (eps^(1/2) for the alternating solver).

    Returns:
        The fit. A solve that fails raises nothing: read `fit.converged`, or `fit.message` for a sentence.

    Raises:
        SymjaxError: for arguments that no plane can be fitted to, before anything is computed; the values of
            traced arguments are not looked at.
    """
    pairs = given_pairs(x, y, weights)
    limits = checked_limits(solver, line_search, max_steps, tol, pairs.x.dtype)
    scale = _checked_sigma(sigma, solver, pairs.x.dtype)
    start = v0 if isinstance(v0, str) else "rga"
    checked_name("v0", start, NORMALS)
    normal = None if v0 is None or isinstance(v0, str) else checked_normals(v0, 1, pairs.x.dtype)
    return _fit_plane(pairs, scale, normal, limits, solver=solver, line_search=line_search, start=start)


def fit_global(
    x: Float[ArrayLike, "n 3"],
    y: Float[ArrayLike, "n 3"],
    sigma: Sigma,
    *,
    weights: Float[ArrayLike, "n"] | None = None,
    num_hypotheses: int = HYPOTHESES,
    num_polished: int = KEPT,
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """Fits the best mirror plane of putative pairs by the L2E estimator: no start is needed.

    Every pair is a hypothesis (its own mirror plane); all are ranked by the criterion on a sample of the pairs, near
    duplicates are left out, the best few are polished for a few steps of Newton's method, on a sample where there are
    many pairs, and the best of those to its end on all. Pure JAX, with the derivatives of `fit_plane`.

    Args:
        x: one end of every pair.
        y: the other end.
        sigma: see `fit_plane`.
        weights: nonnegative weights of the pairs.
        num_hypotheses: how many pairs propose their plane. With a share ρ of mirror pairs, 0.7 ρ of them are right.
        num_polished: how many distinct planes are polished, at a given σ.
        max_steps: limit on the steps of each.
        tol: bound on the gradient, see `fit_plane`.

    Returns:
        The fit of lowest loss; `num_steps` are its last ones, on all pairs.

    Raises:
        SymjaxError: see `fit_plane`.
    """
    pairs = given_pairs(x, y, weights)
    limits = checked_limits("newton", "armijo", max_steps, tol, pairs.x.dtype)
    for name, number in (("num_hypotheses", num_hypotheses), ("num_polished", num_polished)):
        if number < 1:
            raise InvalidArgumentError(f"{name} must be 1 or more, not {number}")
    scale = _checked_sigma(sigma, "newton", pairs.x.dtype)
    return _fit_global(pairs, scale, limits, num_hypotheses=num_hypotheses, num_polished=num_polished)
