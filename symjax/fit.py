"""The mirror plane of putative pairs: one fit, a sweep of fits, and the best of a sweep."""

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float, Int

from symjax.alternation import alternate
from symjax.bfgs import Minimum, minimize
from symjax.checks import checked_normals, checked_pairs, checked_sigmas, checked_weights
from symjax.errors import InvalidArgumentError
from symjax.implicit import implicit_point
from symjax.initial import rga_normal, start_offset
from symjax.linesearch import LINE_SEARCHES
from symjax.objective import l2e_loss, l2e_weights, scaled_log_loss
from symjax.plane import Plane
from symjax.problem import Problem, normalised
from symjax.sphere import SPHERE_LINE, normalise
from symjax.status import RESULTS, sentence

MAX_STEPS = 200
LANES = 16  # fits that share a while loop; more of them wait for the slowest
SOLVERS = {"joint": partial(minimize, manifold=SPHERE_LINE), "alternating": alternate}
# default tol, a power of eps: the alternation's ω solver stops where f itself shows no decrease any more,
# which is at a gradient of about eps^(1/2)
_TOL_POWER = {"joint": 2 / 3, "alternating": 1 / 2}


class Fit(NamedTuple):
    """The fitted plane and how the fit went; leading axes are those of the fits.

    Attributes:
        plane: the plane, of canonical sign, in the units of the points.
        loss: `l2e_loss` at the plane.
        result: how the solve ended, a member of `symjax.status.RESULTS`.
        num_steps: steps of the joint solver, or rounds of the alternating one.
        grad_norm: norm of the Riemannian gradient of ψ (`scaled_log_loss`), the points scaled to unit radius:
            what `tol` bounds.
    """

    plane: Plane
    loss: Float[Array, "*batch"]
    result: RESULTS
    num_steps: Int[Array, "*batch"]
    grad_norm: Float[Array, "*batch"]

    @property
    def converged(self) -> Bool[Array, "*batch"]:
        """Whether the gradient is within tol and some pair supports the plane."""
        code, success = jax.tree.leaves(self.result)[0], jax.tree.leaves(RESULTS.successful)[0]
        return jnp.asarray(code == success)

    @property
    def message(self) -> str | np.ndarray:
        """How the solve ended, a sentence; of a batch, an array of sentences. Not under a trace."""
        return sentence(self.result)


def _psi(z: Float[Array, "4"], theta: tuple[Array, Array, Array, Array]) -> Float[Array, ""]:
    x, y, weights, sigma = theta
    return scaled_log_loss(z[:3], z[3], sigma, x, y, weights=weights)


def _solve(
    problem: Problem,
    sigma: Float[Array, ""],
    v0: Float[Array, "3"],
    tol: Float[Array, ""],
    max_steps: Int[Array, ""],
    *,
    solver: str,
    line_search: str,
) -> Minimum:
    """The minimum near v0 in scaled units; nothing is differentiated through it."""
    (x, y, weights, _, _), sigma, v0 = jax.lax.stop_gradient((problem, sigma, v0))
    v0 = normalise(v0)
    z0 = jnp.append(v0, start_offset(v0, sigma, x, y, weights=weights))
    theta = (x, y, weights, sigma)
    solution = SOLVERS[solver](lambda z: _psi(z, theta), z0, line_search=line_search, max_steps=max_steps, tol=tol)
    v, omega = solution.point[:3], solution.point[3]
    flat = jnp.all(jnp.where(weights > 0, l2e_weights(v, omega, sigma, x, y), 0) == 0)
    return solution._replace(result=RESULTS.where(flat, RESULTS.flat, solution.result))


def _answer(problem: Problem, sigma: Float[Array, ""], solution: Minimum) -> Fit:
    """The fit in the units of the points, differentiable in the problem and in σ."""
    x, y, weights, centre, radius = problem
    z = implicit_point(_psi, SPHERE_LINE, solution.point, (x, y, weights, sigma))
    v, omega = z[:3], z[3]
    plane = Plane(v, jnp.sum(v * centre) + radius * omega).canonical()
    loss = l2e_loss(v, omega, sigma, x, y, weights=weights) / radius**3
    return Fit(plane, loss, solution.result, solution.num_steps, solution.grad_norm)


@partial(jax.jit, static_argnames=("solver", "line_search"))
def _fit_plane(
    x: Array,
    y: Array,
    weights: Array,
    sigma: Array,
    v0: Array | None,
    tol: Array,
    max_steps: Array,
    *,
    solver: str,
    line_search: str,
) -> Fit:
    problem = normalised(x, y, weights)
    sigma = sigma / problem.radius
    if v0 is None:
        v0 = rga_normal(*jax.lax.stop_gradient((problem.x, problem.y)), weights=problem.weights)
    solution = _solve(problem, sigma, v0, tol, max_steps, solver=solver, line_search=line_search)
    return _answer(problem, sigma, solution)


@partial(jax.jit, static_argnames=("solver", "line_search"))
def _sweep(
    x: Array,
    y: Array,
    weights: Array,
    sigmas: Array,
    v0s: Array,
    tol: Array,
    max_steps: Array,
    *,
    solver: str,
    line_search: str,
) -> Fit:
    problem = normalised(x, y, weights)
    sigmas = sigmas / problem.radius
    num = (len(sigmas), len(v0s))
    # lanes of one σ are neighbours: they take about as many steps
    lanes = jnp.repeat(sigmas, num[1]), jnp.tile(v0s, (num[0], 1))
    size = min(LANES, num[0] * num[1])
    padding = -(num[0] * num[1]) % size
    padded = jax.tree.map(lambda a: jnp.concatenate([a, a[:padding]]), lanes)

    def solve(lane: tuple[Array, Array]) -> Minimum:
        return _solve(problem, *lane, tol, max_steps, solver=solver, line_search=line_search)

    solutions = jax.lax.map(solve, padded, batch_size=size)
    grid = jax.tree.map(lambda a: a[: num[0] * num[1]].reshape(*num, *a.shape[1:]), solutions)
    by_start = jax.vmap(_answer, (None, None, 0))
    return jax.vmap(by_start, (None, 0, 0))(problem, sigmas, grid)


def _checked(
    x: ArrayLike,
    y: ArrayLike,
    weights: ArrayLike | None,
    solver: str,
    line_search: str,
    max_steps: int,
    tol: float | None,
) -> tuple[Array, Array, Array, Array, Any]:
    if solver not in SOLVERS:
        raise InvalidArgumentError(f"solver {solver!r} is unknown: choose one of {', '.join(SOLVERS)}")
    if line_search not in LINE_SEARCHES:
        raise InvalidArgumentError(f"line_search {line_search!r} is unknown: choose one of {', '.join(LINE_SEARCHES)}")
    if max_steps < 0:
        raise InvalidArgumentError(f"max_steps must be 0 or more, not {max_steps}")
    x, y = checked_pairs(x, y)
    if tol is None:
        tol = float(jnp.finfo(x.dtype).eps) ** _TOL_POWER[solver]
    if not tol > 0:
        raise InvalidArgumentError(f"tol must be positive, not {tol}")
    return x, y, checked_weights(weights, len(x), x.dtype), jnp.asarray(tol, x.dtype), jnp.asarray(max_steps)


def fit_plane(
    x: Float[ArrayLike, "n 3"],
    y: Float[ArrayLike, "n 3"],
    sigma: Float[ArrayLike, ""],
    v0: Float[ArrayLike, "3"] | None = None,
    *,
    weights: Float[ArrayLike, "n"] | None = None,
    solver: str = "joint",
    line_search: str = "armijo",
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """Fits the mirror plane of putative pairs by the L2E estimator (paper, Eq. 5), from one start.

    Pure JAX: it goes through jit, vmap and grad. The answer has derivatives in x, y, weights and sigma,
    forward and reverse, by the implicit function theorem; none in v0. The criterion has many local optima:
    from one start this finds the nearest; `sweep` tries many.

    Args:
        x: one end of every pair.
        y: the other end; y[i] is the putative mirror image of x[i].
        sigma: scale σ of the residual, in the units of the points.
        v0: unit normal to start from; None is the robust Grassmann average of the mid-points.
        weights: nonnegative weights of the pairs.
        solver: "joint", Riemannian BFGS on S² × R; or "alternating", Algorithm 1 of the paper, slower.
        line_search: "armijo" or "wolfe" (strong).
        max_steps: limit on the steps, or on the rounds of the alternating solver.
        tol: bound on the gradient, see `Fit.grad_norm`; None is eps^(2/3) of the points' type
            (eps^(1/2) for the alternating solver).

    Returns:
        The fit. A solve that fails raises nothing: read `fit.converged`, or `fit.message` for a sentence.

    Raises:
        SymjaxError: for arguments that no plane can be fitted to, before anything is computed; the values of
            traced arguments are not looked at.
    """
    x, y, w, tolerance, limit = _checked(x, y, weights, solver, line_search, max_steps, tol)
    sigma = checked_sigmas(sigma, 0, x.dtype)
    start = None if v0 is None else checked_normals(v0, 1, x.dtype)
    return _fit_plane(x, y, w, sigma, start, tolerance, limit, solver=solver, line_search=line_search)


def sweep(
    x: Float[ArrayLike, "n 3"],
    y: Float[ArrayLike, "n 3"],
    sigmas: Float[ArrayLike, "S"] | Sequence[float],
    v0s: Float[ArrayLike, "R 3"],
    *,
    weights: Float[ArrayLike, "n"] | None = None,
    solver: str = "joint",
    line_search: str = "armijo",
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """`fit_plane` for every σ and every start, compiled once.

    Args:
        x: one end of every pair.
        y: the other end.
        sigmas: scales σ, in the units of the points.
        v0s: unit normals to start from, e.g. `symjax.sphere.fibonacci(64)`.
        weights: nonnegative weights of the pairs.
        solver: see `fit_plane`.
        line_search: see `fit_plane`.
        max_steps: see `fit_plane`.
        tol: see `fit_plane`.

    Returns:
        The fits, with leading axes (S, R).

    Raises:
        SymjaxError: see `fit_plane`.
    """
    x, y, w, tolerance, limit = _checked(x, y, weights, solver, line_search, max_steps, tol)
    sigmas, starts = checked_sigmas(sigmas, 1, x.dtype), checked_normals(v0s, 2, x.dtype)
    return _sweep(x, y, w, sigmas, starts, tolerance, limit, solver=solver, line_search=line_search)


def best(fits: Fit) -> Fit:
    """Of each row of fits, the one of lowest loss among those that converged.

    Where none of a row converged, the one of lowest loss, with its own status.

    Args:
        fits: fits with axes (..., R), such as the (S, R) of a `sweep`.

    Returns:
        The fits without their last axis.
    """
    loss = jnp.where(jnp.isnan(fits.loss), jnp.inf, fits.loss)
    candidate = fits.converged | ~jnp.any(fits.converged, axis=-1, keepdims=True)
    # at equal losses the converged comes first, also where every loss is infinite
    index = jnp.argmin(jnp.where(candidate, loss, jnp.inf), axis=-1)
    axis = fits.loss.ndim - 1

    def pick(leaf: Array) -> Array:
        where = index.reshape(*index.shape, *[1] * (leaf.ndim - axis))
        return jnp.squeeze(jnp.take_along_axis(leaf, where, axis=axis), axis=axis)

    return jax.tree.map(pick, fits)
