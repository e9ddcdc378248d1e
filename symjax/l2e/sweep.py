"""Sweeps: fits for every scale σ and every start, and for many clouds."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, PRNGKeyArray, Real

from symjax.errors import InvalidArgumentError
from symjax.geometry.arrays import AnyArray
from symjax.geometry.checks import choice, flag, whole
from symjax.geometry.directions import fibonacci
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit import Fit, unscale
from symjax.l2e.jax_config import float64_as_given
from symjax.l2e.manifolds import normalise, random_points
from symjax.l2e.pairs.arguments import Points, Weights, checked_normals, checked_sigmas
from symjax.l2e.pairs.normalised import NormalisedPairs, normalise_pairs
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs
from symjax.l2e.solvers.base import Limits, Minimum, Solver, solve, with_start
from symjax.l2e.solvers.batched import NUM_SLOTS, Make, solve_sharded
from symjax.l2e.solvers.names import AnySolver
from symjax.l2e.solvers.registry import MAX_STEPS, checked_limits, make_solver
from symjax.l2e.starts.hypotheses import offset_search, pair_hypotheses, plane_nms, rank_hypotheses
from symjax.l2e.starts.initialisation import NORMALS
from symjax.l2e.starts.names import STARTS

RESTARTS = 64
PATHS = 32
"""Distinct planes that a continuation follows from one σ to the next."""


class _Options(NamedTuple):
    """What a sweep is compiled for."""

    solver: AnySolver
    start: str | None
    restarts: int
    continuation: bool


@partial(jax.jit, static_argnames="options")
def _sweep(
    pairs: PaddedPairs, sigmas: Float[Array, " S"], v0s: Float[Array, "R 3"] | None, limits: Limits, options: _Options
) -> Fit:
    normalised = normalise_pairs(pairs.x, pairs.y, pairs.weights)
    scaled = sigmas / normalised.to_given.scale
    constant, scales = jax.lax.stop_gradient((normalised, scaled))
    rows = features(*constant[:3], used=pairs.used)
    starts = _starts(constant, scales, v0s, options)
    plane_at = offset_search(constant)

    def make(sigma: Float[Array, ""]) -> Solver:
        # a normal is given its offset as its solve begins: that too is then done in parallel, and in little memory
        solver = make_solver(options.solver, Criterion(rows, sigma), limits)
        return with_start(solver, lambda start: start if len(start) == 4 else plane_at(start, sigma))

    by_sigma = jax.vmap(jax.vmap(unscale, (None, None, 0, 0)), (None, 0, 0, 0))
    if options.continuation:
        minima, row = _continuation(make, constant, scales, starts[jnp.argmax(scales)])
        fits = by_sigma(normalised, scaled, minima, None)
        return jax.tree.map(lambda leaf: jax.vmap(lambda of_sigma, row: of_sigma[row])(leaf, row), fits)
    found = solve_sharded(make, jnp.repeat(scales, starts.shape[1]), starts.reshape(-1, starts.shape[-1]))
    found = jax.tree.map(lambda leaf: leaf.reshape(*starts.shape[:2], *leaf.shape[1:]), found)
    return by_sigma(normalised, scaled, *found)


def _starts(
    pairs: NormalisedPairs, scales: Float[Array, " S"], v0s: Float[Array, "R 3"] | None, options: _Options
) -> Float[Array, "S R d"]:
    """The normals, or the planes (d = 4), to start from at every σ."""
    if options.start == "hypotheses":
        proposed = pair_hypotheses(pairs)
        return jax.lax.map(lambda sigma: rank_hypotheses(proposed, pairs, sigma, num=options.restarts), scales)
    if v0s is None:
        v0s = NORMALS[options.start or "rga"](pairs.x, pairs.y, weights=pairs.weights)[None]
    v0s = jax.vmap(normalise)(jax.lax.stop_gradient(v0s))
    return jnp.broadcast_to(v0s[None], (len(scales), *v0s.shape))


def _continuation(
    make: Make, pairs: NormalisedPairs, scales: Float[Array, " S"], starts: Float[Array, "R d"]
) -> tuple[Minimum, Int[Array, "S R"]]:
    """The optima of a continuation, from the largest σ to the smallest.

    It takes the best distinct planes that the starts reach at the largest σ. From then on it starts from their optima
    at the last σ, and from the hypotheses ranked anew, since plain warm starts follow the wrong plane where outliers
    have a structure.

    Returns:
        At every σ all optima, and which of them each start's is: its path's, or the best of the hypotheses' if that is
        better.
    """
    order = jnp.argsort(-scales)
    proposed = pair_hypotheses(pairs)
    num_paths = min(PATHS, len(starts))
    solver = make(scales[order[0]])
    # no more of them at a time than step together elsewhere: their weights take the memory
    begun, _ = jax.lax.map(
        lambda start: solver.finish(solver.init(start)), starts, batch_size=min(NUM_SLOTS, len(starts))
    )
    first = plane_nms(begun.point, begun.value, num_paths)
    cosine = jnp.abs(jnp.sum(begun.point[:, None, :3] * begun.point[None, first, :3], axis=2))
    path = jnp.argmax(cosine, axis=1)

    def follow(paths: Float[Array, "K 4"], sigma: Float[Array, ""]) -> tuple[Array, tuple[Minimum, Array]]:
        here = jnp.concatenate([paths, rank_hypotheses(proposed, pairs, sigma)])
        found, _ = jax.vmap(partial(solve, make(sigma)))(here)
        value = jnp.where(jnp.isfinite(found.value), found.value, jnp.inf)
        best = num_paths + jnp.argmin(value[num_paths:])
        return found.point[:num_paths], (found, jnp.where(value[path] <= value[best], path, best))

    _, followed = jax.lax.scan(follow, begun.point[first], scales[order])
    back = jnp.argsort(order)
    return jax.tree.map(lambda leaf: leaf[back], followed)


@float64_as_given
def sweep(
    x: Points,
    y: Points,
    sigmas: Real[AnyArray, " S"] | Sequence[float],
    v0s: Real[AnyArray, "R 3"] | Sequence[Sequence[float]] | str = "hypotheses",
    *,
    restarts: int = RESTARTS,
    key: PRNGKeyArray | None = None,
    weights: Weights | None = None,
    solver: AnySolver = "newton",
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
        continuation: go from the largest σ to the smallest, each from the optima of the last. Many times cheaper.
            The starts count at the largest σ, where the best distinct of them are taken; at every σ the hypotheses
            are ranked again, and a start's fit is its path's optimum or the best that a hypothesis reaches, whichever
            is better: it shows the best plane at every σ, not the basins.
        max_steps: see `fit_plane`.
        tol: see `fit_plane`.

    Returns:
        The fits, with leading axes (S, R).

    Raises:
        SymjaxError: see `fit_plane`.
    """
    pairs = pad_pairs(x, y, weights)
    dtype = pairs.x.dtype
    limits = checked_limits(solver, max_steps, tol, dtype)
    scales = checked_sigmas(sigmas, 1, dtype)
    restarts, continuation = whole("restarts", restarts, 1), flag("continuation", continuation)
    start = v0s if isinstance(v0s, str) else None
    normals = _named_normals(start, restarts, key, dtype) if isinstance(v0s, str) else checked_normals(v0s, 2, dtype)
    options = _Options(solver, start if normals is None else None, restarts, continuation)
    return _sweep(pairs, scales, normals, limits, options)


def _named_normals(
    start: str | None, restarts: int, key: PRNGKeyArray | None, dtype: Any
) -> Float[Array, "R 3"] | None:
    """The starting normals of a name that needs no pairs."""
    choice("v0s", start, STARTS)
    if (start == "random") != (key is not None):
        raise InvalidArgumentError("v0s='random' takes a key, jax.random.key(seed), and no other start does")
    if start == "fibonacci":
        return jnp.asarray(fibonacci(restarts), dtype)
    return random_points(key, restarts).astype(dtype) if key is not None else None


def sweep_clouds(clouds: Iterable[tuple[Points, Points]], *args: Any, **options: Any) -> Fit:
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
    # NumPy's float64 fits stay in NumPy
    return jax.tree.map(lambda *leaves: leaves[0].__array_namespace__().stack(leaves), *fits)
