"""Sweeps: fits for every scale σ and every start, for one or many sets of pairs."""

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
from symjax.l2e.jax_config import jit, keep_float64
from symjax.l2e.manifolds import normalise, random_points
from symjax.l2e.pairs.arguments import AnyPoints, Points, Weights, checked_normals, checked_sigmas
from symjax.l2e.pairs.normalised import NormalisedPairs, normalise_pairs
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs
from symjax.l2e.solvers.base import Limits, Minimum, Solver, solve, with_start
from symjax.l2e.solvers.batched import NUM_SLOTS, SolverFactory, solve_sharded
from symjax.l2e.solvers.names import AnySolver
from symjax.l2e.solvers.registry import MAX_STEPS, checked_limits, make_solver
from symjax.l2e.starts.hypotheses import offset_search, pair_hypotheses, plane_nms, rank_hypotheses
from symjax.l2e.starts.initialisation import NORMALS
from symjax.l2e.starts.names import STARTS

RESTARTS = 64
NUM_PATHS = 32
"""Largest number of distinct planes that a continuation follows from one σ to the next."""


class _Options(NamedTuple):
    """Options that a sweep is compiled for."""

    solver: AnySolver
    start: str | None
    restarts: int
    continuation: bool


@jit(static_argnames="options")
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
        # the offset of a starting normal is found when its solve begins: in parallel, and with little memory
        solver = make_solver(options.solver, Criterion(rows, sigma), limits)
        return with_start(solver, lambda start: start if len(start) == 4 else plane_at(start, sigma))

    by_sigma = jax.vmap(jax.vmap(unscale, (None, None, 0, 0)), (None, 0, 0, 0))
    if options.continuation:
        minima, row = _continuation(make, constant, scales, starts[jnp.argmax(scales)])
        fits = by_sigma(normalised, scaled, minima, None)
        chosen: Fit = jax.tree.map(lambda leaf: jax.vmap(lambda of_sigma, row: of_sigma[row])(leaf, row), fits)
        return chosen
    found = solve_sharded(make, jnp.repeat(scales, starts.shape[1]), starts.reshape(-1, starts.shape[-1]))
    found = jax.tree.map(lambda leaf: leaf.reshape(*starts.shape[:2], *leaf.shape[1:]), found)
    return by_sigma(normalised, scaled, *found)


def _starts(
    pairs: NormalisedPairs, scales: Float[Array, " S"], v0s: Float[Array, "R 3"] | None, options: _Options
) -> Float[Array, "S R d"]:
    """Returns the starts at every σ: normals (d = 3) or planes (d = 4)."""
    if options.start == "hypotheses":
        proposed = pair_hypotheses(pairs)
        planes: Float[Array, "S R 4"] = jax.lax.map(
            lambda sigma: rank_hypotheses(proposed, pairs, sigma, num=options.restarts), scales
        )
        return planes
    if v0s is None:
        v0s = NORMALS[options.start or "rga"](pairs.x, pairs.y, weights=pairs.weights)[None]
    v0s = jax.vmap(normalise)(jax.lax.stop_gradient(v0s))
    return jnp.broadcast_to(v0s[None], (len(scales), *v0s.shape))


def _continuation(
    make: SolverFactory, pairs: NormalisedPairs, scales: Float[Array, " S"], starts: Float[Array, "R d"]
) -> tuple[Minimum, Int[Array, "S R"]]:
    """Follows optima from the largest σ to the smallest.

    The paths begin at the best distinct starts at the largest σ, and every start belongs to the path with the nearest
    normal. At every σ the solver starts from the paths' optima at the σ before, and from the hypotheses ranked anew:
    warm starts alone follow the wrong plane if the outliers have a structure.

    Returns:
        All minima at every σ, and for every start the row of its minimum: that of its path, or the best from a
        hypothesis if that is better.
    """
    order = jnp.argsort(-scales)
    proposed = pair_hypotheses(pairs)
    num_paths = min(NUM_PATHS, len(starts))
    solver = make(scales[order[0]])
    # planes and losses of the starts, in batches no larger than those of `solve_batch`: their weights take the memory
    at_start, _ = jax.lax.map(
        lambda start: solver.finish(solver.init(start)), starts, batch_size=min(NUM_SLOTS, len(starts))
    )
    first = plane_nms(at_start.point, at_start.value, num_paths)
    cosine = jnp.abs(jnp.sum(at_start.point[:, None, :3] * at_start.point[None, first, :3], axis=2))
    path = jnp.argmax(cosine, axis=1)

    def follow(paths: Float[Array, "K 4"], sigma: Float[Array, ""]) -> tuple[Array, tuple[Minimum, Int[Array, " R"]]]:
        here = jnp.concatenate([paths, rank_hypotheses(proposed, pairs, sigma)])
        found, _ = jax.vmap(partial(solve, make(sigma)))(here)
        value = jnp.where(jnp.isfinite(found.value), found.value, jnp.inf)
        best = num_paths + jnp.argmin(value[num_paths:])
        return found.point[:num_paths], (found, jnp.where(value[path] <= value[best], path, best))

    _, followed = jax.lax.scan(follow, at_start.point[first], scales[order])
    back = jnp.argsort(order)
    in_given_order: tuple[Minimum, Int[Array, "S R"]] = jax.tree.map(lambda leaf: leaf[back], followed)
    return in_given_order


@keep_float64
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
    """Runs `fit_plane` for every σ and every start, compiled once, on all devices that JAX sees.

    Args:
        x: one end of every pair, in any unit.
        y: the other end, in the same unit.
        sigmas: scales σ of the residual, in the units of the points.
        v0s: unit normals to start from, or the name of `restarts` starts: "hypotheses", the best distinct planes
            proposed by single pairs, ranked at every σ; "fibonacci", evenly spaced directions; "random", directions
            drawn with `key`. The names "rga", "pca" and "l2" give one start, see `fit_plane`.
        restarts: number of starts "hypotheses", "fibonacci" or "random".
        key: key of the random starts, `jax.random.key(seed)`. It is required for "random" and refused otherwise.
        weights: nonnegative weights of the pairs, by default all 1.
        solver: solver, see `fit_plane`.
        continuation: whether to go from the largest σ to the smallest and start from the optima of the σ before, which
            is many times cheaper. Only the best distinct starts at the largest σ are followed, and the other starts
            join the path with the nearest normal. The hypotheses are ranked again at every σ. The fit of a start is
            the optimum of its path, or the best optimum reached from a hypothesis if that is better. A continuation
            therefore shows the best plane at every σ, not the basins of attraction.
        max_steps: limit on the steps of each fit, see `fit_plane`.
        tol: tolerance of the gradient norm, see `fit_plane`.

    Returns:
        The fits, with leading axes (S, R): scales and starts.

    Raises:
        SymjaxError: if an argument is invalid, see `fit_plane`.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.4)
        >>> fits = symjax.sweep(pairs.x, pairs.y, [0.01, 0.1], restarts=8)
        >>> fits.loss.shape, symjax.best(fits).loss.shape
        ((2, 8), (2,))
        >>> print(pairs.normal.round(2), symjax.best(fits).plane.normal.round(2))
        [-0.33 -0.27  0.91] [[-0.33 -0.27  0.9 ]
         [-0.33 -0.27  0.9 ]]
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
    """Returns the starting normals of "fibonacci" and "random", and None for the starts that depend on the pairs."""
    choice("v0s", start, STARTS)
    if (start == "random") != (key is not None):
        raise InvalidArgumentError("v0s='random' takes a key, jax.random.key(seed), and no other start takes one")
    if start == "fibonacci":
        return jnp.asarray(fibonacci(restarts), dtype)
    return random_points(key, restarts).astype(dtype) if key is not None else None


def sweep_clouds(clouds: Iterable[tuple[AnyPoints, AnyPoints]], *args: Any, **options: Any) -> Fit:
    """Runs `sweep` for the pairs of many clouds.

    The clouds may have different numbers of pairs. These are padded to powers of two, so few programs are compiled.

    Args:
        clouds: the pairs (x, y) of each cloud, in a list or a generator.
        *args: `sigmas`, and optionally `v0s`, of `sweep`.
        **options: options of `sweep`.

    Returns:
        The fits, with leading axes (C, S, R): clouds, scales and starts.

    Raises:
        SymjaxError: if an argument is invalid, see `sweep`, or if `clouds` is empty.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> clouds = [planted_pairs(np.random.default_rng(0), num, outliers=0.4) for num in (50, 100)]
        >>> fits = symjax.sweep_clouds([(p.x, p.y) for p in clouds], [0.01, 0.1], restarts=8)
        >>> fits.loss.shape, symjax.best(fits).loss.shape
        ((2, 2, 8), (2, 2))
    """
    fits = [sweep(x, y, *args, **options) for x, y in clouds]
    if not fits:
        raise InvalidArgumentError("clouds is empty: pass the pairs (x, y) of at least one cloud")
    # NumPy's float64 fits stay in NumPy
    stacked: Fit = jax.tree.map(lambda *leaves: leaves[0].__array_namespace__().stack(leaves), *fits)
    return stacked
