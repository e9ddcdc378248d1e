"""The plane of putative pairs: starts of the estimator, the distinct optima that they reach, and their scores."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import suppress
from symjax.l2e.fit import Fit
from symjax.l2e.objective import l2e_weights
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs
from symjax.l2e.solvers.names import AnySolver
from symjax.l2e.starts import initialisation
from symjax.l2e.sweep import sweep
from symjax.method.result import Candidate

SAME_ANGLE, SAME_OFFSET = 5.0, 0.03
"""Planes nearer to each other than this (degrees, units of the points) are one optimum."""

NAMED = ("rga", "pca", "l2")
"""Names of the starts of `_named_starts`, in order."""

NUM_RANDOM_PLANES = 1024
RANDOM_QUANTILE, FOUND_FACTOR = 0.95, 3.0
"""The threshold is 3 times the 0.95 quantile of the scores of 1024 random planes."""


class CandidateFits(NamedTuple):
    """The distinct planes that the estimator reached from its starts.

    Attributes:
        candidates: the distinct optima, converged ones first, then by loss. Their score is the mean L2E weight of the
            pairs.
        weight: L2E weights of the pairs at the first candidate.
        threshold: score that a mirror plane exceeds.
        converged: whether the solver converged at the first candidate.
        message: how it ended there, as a sentence.
    """

    candidates: tuple[Candidate, ...]
    weight: Float[np.ndarray, " m"]
    threshold: float
    converged: bool
    message: str


def fit_candidates(
    x: Float[np.ndarray, "m 3"],
    y: Float[np.ndarray, "m 3"],
    sigma: float,
    *,
    starts: str,
    restarts: int,
    solver: AnySolver,
    rng: np.random.Generator,
) -> CandidateFits:
    """Fits the plane of putative pairs from several starts, in float64.

    Args:
        x: first point of every pair, about the mean of the cloud, in units of its diagonal.
        y: second point of every pair.
        sigma: scale σ of the residual, in the same units.
        starts: `"all"` or the name of one start, see `SymHKS`.
        restarts: number of starts for `"all"`: the robust Grassmann average of the paper, the least principal
            direction, the least-squares plane, the planes of the best single pairs, and evenly spread directions.
        solver: see `fit_plane`.
        rng: draws the random planes that the threshold is derived from.

    Returns:
        The distinct optima, the L2E weights of the pairs, and the threshold.
    """
    with jax.enable_x64(True):
        pairs = pad_pairs(x, y, None)
        fits = sweep(
            pairs.x,
            pairs.y,
            np.array([sigma]),
            _starts(pairs, sigma, starts, restarts),
            weights=pairs.weights,
            solver=solver,
        )
        candidates, first = _distinct(fits, pairs, sigma)
        weight = _weights(jax.tree.map(lambda leaf: leaf[None], candidates[0].plane), sigma, pairs)[0, : len(x)]
        threshold = FOUND_FACTOR * float(np.quantile(_scores(_random_planes(x, y, rng), sigma, pairs), RANDOM_QUANTILE))
        return CandidateFits(candidates, weight, threshold, bool(first.converged), str(first.message))


def _starts(pairs: PaddedPairs, sigma: float, starts: str, restarts: int) -> Float[np.ndarray, "r 3"]:
    """Returns unit normals: the three named starts, the planes of the best single pairs, evenly spread directions."""
    named = np.asarray(_named_starts(pairs))[:restarts]
    if starts != "all":
        row = NAMED.index(starts)
        return np.asarray(_named_starts(pairs))[row : row + 1]
    half = (restarts - len(named)) // 2
    # their number is always the same, since the program is compiled anew for every number
    of_pairs = np.concatenate([_pair_normals(pairs, sigma, half), fibonacci(max(half, 1))])[:half]
    even = fibonacci(max(restarts - len(named) - half, 1))
    return np.concatenate([named, of_pairs, even])[:restarts]


@jax.jit
def _named_starts(pairs: PaddedPairs) -> Float[Array, "3 3"]:
    x, y, weights, _ = pairs
    rga = initialisation.rga_normal(x, y, weights=weights)
    pca = initialisation.pca_normal(x, y, weights=weights)
    return jnp.stack([rga, pca, initialisation.l2_plane(x, y, weights).normal])


def _pair_normals(pairs: PaddedPairs, sigma: float, most: int) -> Float[np.ndarray, "r 3"]:
    """Returns the distinct normals of the planes that map one pair onto each other, in order of their scores."""
    x, y, real, _ = (np.asarray(leaf) for leaf in pairs)
    step = y - x
    length = np.linalg.norm(step, axis=1, keepdims=True)
    normals = step / np.where(length > 0, length, 1.0)
    planes = Plane(normals, (normals * (x + y) / 2).sum(axis=1))
    order = np.argsort(-_scores(planes, sigma, pairs), kind="stable")
    rows = suppress(planes, order[real[order] > 0], angle=SAME_ANGLE, offset=SAME_OFFSET, most=most)
    distinct: Float[np.ndarray, "r 3"] = normals[rows]
    return distinct


def _distinct(fits: Fit, pairs: PaddedPairs, sigma: float) -> tuple[tuple[Candidate, ...], Fit]:
    """Returns the distinct optima of the fits, converged ones first, then by loss; and the fit of the first."""
    row = jax.tree.map(lambda leaf: leaf[0], fits)
    loss = np.asarray(row.loss)
    planes = Plane(np.asarray(row.plane.normal), np.asarray(row.plane.offset))
    kept = suppress(
        planes,
        np.lexsort((loss, ~np.asarray(row.converged))),
        angle=SAME_ANGLE,
        offset=SAME_OFFSET,
        most=len(loss),
    )
    scores = _scores(planes, sigma, pairs)
    candidates = tuple(
        Candidate(Plane(planes.normal[i], planes.offset[i]), float(scores[i]), float(scores[i])) for i in kept
    )
    return candidates, jax.tree.map(lambda leaf: leaf[kept[0]], row)


def _random_planes(x: Float[np.ndarray, "m 3"], y: Float[np.ndarray, "m 3"], rng: np.random.Generator) -> Plane:
    """Draws planes with uniformly distributed normals through the mid-points of random pairs."""
    normals = rng.normal(size=(NUM_RANDOM_PLANES, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    row = rng.integers(len(x), size=NUM_RANDOM_PLANES)
    return Plane(normals, (normals * (x[row] + y[row]) / 2).sum(axis=1))


def _weights(planes: Plane, sigma: float, pairs: PaddedPairs) -> Float[np.ndarray, "p b"]:
    return np.asarray(_all_weights(planes, jnp.asarray(sigma), pairs))


@jax.jit
def _all_weights(planes: Plane, sigma: Float[Array, ""], pairs: PaddedPairs) -> Float[Array, "p b"]:
    """Computes the L2E weight of every pair at every plane; zero for padding."""

    def weights(v: Float[Array, " 3"], omega: Float[Array, ""]) -> Float[Array, " b"]:
        return jnp.asarray(l2e_weights(v, omega, sigma, pairs.x, pairs.y)) * pairs.weights

    return jax.vmap(weights)(jnp.asarray(planes.normal), jnp.asarray(planes.offset))


def _scores(planes: Plane, sigma: float, pairs: PaddedPairs) -> Float[np.ndarray, " p"]:
    """Computes the mean L2E weight of the pairs, without the padding, at every plane."""
    mean: Float[np.ndarray, " p"] = _weights(planes, sigma, pairs).sum(axis=1) / float(pairs.weights.sum())
    return mean
