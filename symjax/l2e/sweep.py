"""Sweeps: fits for every scale σ and every start, and for many clouds."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, ArrayLike, Float, Int, PRNGKeyArray

from symjax.errors import InvalidArgumentError
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit import Fit
from symjax.l2e.fit_plane import MAX_STEPS, checked_limits
from symjax.l2e.manifolds import fibonacci, normalise, random_points
from symjax.l2e.pairs.arguments import checked_name, checked_normals, checked_sigmas
from symjax.l2e.pairs.normalized import Problem, normalised
from symjax.l2e.pairs.padded import Pairs, given_pairs
from symjax.l2e.pairs.unscale import answered
from symjax.l2e.solvers.base import Limits, Minimum, Solver, solve
from symjax.l2e.solvers.batched import WIDTH, Make, sharded
from symjax.l2e.solvers.registry import SOLVERS
from symjax.l2e.starts.hypotheses import distinct, hypotheses, lift, screened
from symjax.l2e.starts.initialization import NORMALS

RESTARTS = 64
PATHS = 32
"""Distinct planes that a continuation follows from one σ to the next."""

STARTS = (*NORMALS, "fibonacci", "random", "hypotheses")
"""The starts by name."""


class _Options(NamedTuple):
    """What a sweep is compiled for."""

    solver: str
    line_search: str
    start: str | None
    restarts: int
    continuation: bool


@partial(jax.jit, static_argnames="options")
def _sweep(
    pairs: Pairs, sigmas: Float[Array, "S"], v0s: Float[Array, "R 3"] | None, limits: Limits, options: _Options
) -> Fit:
    problem = normalised(pairs.x, pairs.y, pairs.weights)
    scaled = sigmas / problem.radius
    constant, scales = jax.lax.stop_gradient((problem, scaled))
    rows = features(*constant[:3], used=pairs.used)

    starts = _starts(constant, scales, v0s, options)
    raised = lift(constant)

    def make(sigma: Float[Array, ""]) -> Solver:
        solver = SOLVERS[options.solver](Criterion(rows, sigma), limits, options.line_search)
        # a normal is given its offset as its lane begins: that too is then done in parallel, and in little memory
        return solver._replace(init=lambda start: solver.init(start if len(start) == 4 else raised(start, sigma)))

    by_sigma = jax.vmap(jax.vmap(answered, (None, None, 0)), (None, 0, 0))
    if options.continuation:
        found, lane = _followed(make, constant, scales, starts[jnp.argmax(scales)])
        fits = by_sigma(problem, scaled, found)
        return jax.tree.map(lambda leaf: jax.vmap(lambda row, which: row[which])(leaf, lane), fits)
    lanes = jnp.repeat(scales, starts.shape[1]), starts.reshape(-1, starts.shape[-1])
    found = jax.tree.map(lambda leaf: leaf.reshape(*starts.shape[:2], *leaf.shape[1:]), sharded(make, *lanes))
    return by_sigma(problem, scaled, found)


def _starts(
    problem: Problem, scales: Float[Array, "S"], v0s: Float[Array, "R 3"] | None, options: _Options
) -> Float[Array, "S R d"]:
    """The normals, or the planes (d = 4), to start from at every σ."""
    if options.start == "hypotheses":
        proposed = hypotheses(problem)
        return jax.lax.map(lambda sigma: screened(proposed, problem, sigma, num=options.restarts), scales)
    if v0s is None:
        v0s = NORMALS[options.start or "rga"](problem.x, problem.y, weights=problem.weights)[None]
    v0s = jax.vmap(normalise)(jax.lax.stop_gradient(v0s))
    return jnp.broadcast_to(v0s[None], (len(scales), *v0s.shape))


def _followed(
    make: Make, problem: Problem, scales: Float[Array, "S"], starts: Float[Array, "R d"]
) -> tuple[Minimum, Int[Array, "S R"]]:
    """The optima of a continuation, from the largest σ to the smallest.

    From the starts, the best distinct planes at the largest σ; from then on, their optima at the last σ and the
    hypotheses screened anew, since plain warm starts follow the wrong plane where outliers have a structure.

    Returns:
        At every σ all optima, and which of them each start's is: its path's, or the best of the screened if that is
        better.
    """
    order = jnp.argsort(-scales)
    proposed = hypotheses(problem)
    num_paths = min(PATHS, len(starts))
    solver = make(scales[order[0]])
    # no more of them at a time than step together elsewhere: their weights take the memory
    begun = jax.lax.map(lambda start: solver.finish(solver.init(start)), starts, batch_size=min(WIDTH, len(starts)))
    first = distinct(begun.point, begun.value, num_paths)
    cosine = jnp.abs(jnp.sum(begun.point[:, None, :3] * begun.point[None, first, :3], axis=2))
    path = jnp.argmax(cosine, axis=1)

    def follow(paths: Float[Array, "K 4"], sigma: Float[Array, ""]) -> tuple[Array, tuple[Minimum, Array]]:
        here = jnp.concatenate([paths, screened(proposed, problem, sigma)])
        found = jax.vmap(partial(solve, make(sigma)))(here)
        value = jnp.where(jnp.isfinite(found.value), found.value, jnp.inf)
        best = num_paths + jnp.argmin(value[num_paths:])
        return found.point[:num_paths], (found, jnp.where(value[path] <= value[best], path, best))

    _, followed = jax.lax.scan(follow, begun.point[first], scales[order])
    back = jnp.argsort(order)
    return jax.tree.map(lambda leaf: leaf[back], followed)


def sweep(
    x: Float[ArrayLike, "n 3"],
    y: Float[ArrayLike, "n 3"],
    sigmas: Float[ArrayLike, "S"] | Sequence[float],
    v0s: Float[ArrayLike, "R 3"] | str = "hypotheses",
    *,
    restarts: int = RESTARTS,
    key: PRNGKeyArray | None = None,
    weights: Float[ArrayLike, "n"] | None = None,
    solver: str = "newton",
    line_search: str = "armijo",
    continuation: bool = False,
    max_steps: int = MAX_STEPS,
    tol: float | None = None,
) -> Fit:
    """`fit_plane` for every σ and every start, compiled once, on every device that JAX sees.

    Args:
        x: one end of every pair.
        y: the other end.
        sigmas: scales σ, in the units of the points.
        v0s: unit normals to start from; or by name, `restarts` of them: "hypotheses", at every σ the best distinct
            planes that single pairs propose; "fibonacci", even directions; "random" ones of a `key`; or one, "rga",
            "pca" or "l2" as in `fit_plane`.
        restarts: number of the starts that are given by name.
        key: of the random starts.
        weights: nonnegative weights of the pairs.
        solver: see `fit_plane`.
        line_search: see `fit_plane`.
        continuation: go from the largest σ to the smallest, each from the optima of the last. Many times cheaper.
            The starts count at the largest σ, where the best distinct of them are taken; at every σ the hypotheses
            are screened again, and a start's fit is its path's optimum or the best screened one, whichever is
            better: it shows the best plane at every σ, not the basins.
        max_steps: see `fit_plane`.
        tol: see `fit_plane`.

    Returns:
        The fits, with leading axes (S, R).

    Raises:
        SymjaxError: see `fit_plane`.
    """
    pairs = given_pairs(x, y, weights)
    dtype = pairs.x.dtype
    limits = checked_limits(solver, line_search, max_steps, tol, dtype)
    scales = checked_sigmas(sigmas, 1, dtype)
    start = v0s if isinstance(v0s, str) else None
    normals = _named(start, restarts, key, dtype) if isinstance(v0s, str) else checked_normals(v0s, 2, dtype)
    options = _Options(solver, line_search, start if normals is None else None, restarts, continuation)
    return _sweep(pairs, scales, normals, limits, options)


def _named(start: str | None, restarts: int, key: PRNGKeyArray | None, dtype: Any) -> Float[Array, "R 3"] | None:
    """The starting normals of a name that needs no pairs."""
    checked_name("v0s", str(start), STARTS)
    if restarts < 1:
        raise InvalidArgumentError(f"restarts must be 1 or more, not {restarts}")
    if (start == "random") != (key is not None):
        raise InvalidArgumentError("v0s='random' takes a key, jax.random.key(seed), and no other start does")
    if start == "fibonacci":
        return fibonacci(restarts).astype(dtype)
    return random_points(key, restarts).astype(dtype) if key is not None else None


def sweep_clouds(
    clouds: Iterable[tuple[Float[ArrayLike, "n 3"], Float[ArrayLike, "n 3"]]], *args: Any, **options: Any
) -> Fit:
    """`sweep` for the pairs of many clouds, of any sizes: few of those are compiled.

    Args:
        clouds: pairs (x, y) of each cloud; they may come one at a time.
        *args: of `sweep`.
        **options: of `sweep`.

    Returns:
        The fits, with leading axes (C, S, R).

    Raises:
        SymjaxError: see `sweep`; and where there is no cloud.
    """
    fits = [sweep(x, y, *args, **options) for x, y in clouds]
    if not fits:
        raise InvalidArgumentError("there is no cloud to sweep")
    return jax.tree.map(lambda *leaves: jnp.stack(leaves), *fits)
