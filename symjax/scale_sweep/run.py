"""A sweep over σ and starts, some σ at a time."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.fit import Fit, best
from symjax.l2e.fit_global import fit_global
from symjax.l2e.starts.initialisation import NORMALS
from symjax.l2e.sweep import sweep
from symjax.scale_sweep.optima import ranks
from symjax.scale_sweep.pairs import SweepPairs

SLOTS = 1024
"""Fits that are computed together, at least: enough to keep the cores busy, and a fraction of a second."""


class Options(NamedTuple):
    """How a scale sweep is made.

    Attributes:
        start: name of the starts, see `symjax.sweep`.
        restarts: number of them; of the starts that are one, 1.
        solver: see `symjax.fit_plane`.
        continuation: see `symjax.sweep`; the starts are then not known at every σ.
        seed: of random starts.
    """

    start: str
    restarts: int
    solver: str
    continuation: bool
    seed: int


class ScaleSweep(NamedTuple):
    """Fits of one set of pairs for every σ and every start. Planes are in the units of the pairs.

    Attributes:
        pairs: the pairs.
        options: how they were swept.
        fractions: σ as fractions of the diagonal.
        fits: the fits.
        rank: rank by loss of the optimum that each reached, at its σ (`symjax.scale_sweep.optima`).
        best: the best fit at every σ.
        estimated: the best fit of all, σ estimated with the plane.
    """

    pairs: SweepPairs
    options: Options
    fractions: Float[np.ndarray, " S"]
    fits: Fit
    rank: Int[np.ndarray, "S R"]
    best: Fit
    estimated: Fit


def scale_sweep(
    pairs: SweepPairs,
    fractions: Sequence[float],
    options: Options,
    *,
    stage: Callable[[str], None],
    advance: Callable[[int, int], None],
) -> ScaleSweep:
    """Sweeps pairs over σ and starts, in float64, and looks for the best plane of all.

    Args:
        pairs: the pairs.
        fractions: scales σ as fractions of the diagonal.
        options: see `Options`.
        stage: called with the name of every stage as it begins.
        advance: called with the number of σ that are done, and of all.

    Raises:
        SymjaxError: see `symjax.sweep`.
    """
    sigmas = np.asarray(fractions, float) * pairs.diagonal
    if options.start in NORMALS:
        options = options._replace(restarts=1)
    fits = _swept(pairs, sigmas, options, stage, advance)
    stage("estimating sigma")
    estimated = _known(fit_global(pairs.x, pairs.y, "auto"))
    rank = np.stack(
        [
            ranks(Plane(*planes), loss, converged, centre=pairs.centre, diagonal=pairs.diagonal)
            for *planes, loss, converged in zip(*fits.plane, fits.loss, np.asarray(fits.converged), strict=True)
        ]
    )
    return ScaleSweep(pairs, options, np.asarray(fractions, float), fits, rank, best(fits), estimated)


def _swept(
    pairs: SweepPairs,
    sigmas: Float[np.ndarray, " S"],
    options: Options,
    stage: Callable[[str], None],
    advance: Callable[[int, int], None],
) -> Fit:
    """The fits, from sweeps of one compiled shape."""
    is_whole = options.continuation
    parts = -(-len(sigmas) * options.restarts // SLOTS)
    size = len(sigmas) if is_whole else -(-len(sigmas) // min(parts, len(sigmas)))
    key = jax.random.key(options.seed) if options.start == "random" else None

    def run(some: Float[np.ndarray, " s"]) -> Fit:
        padded = np.concatenate([some, np.repeat(some[-1:], size - len(some))])
        fits = sweep(
            pairs.x,
            pairs.y,
            padded,
            options.start,
            restarts=options.restarts,
            key=key,
            solver=options.solver,
            continuation=options.continuation,
        )
        return jax.tree.map(lambda leaf: leaf[: len(some)], _known(fits))

    stage("sweeping sigma")
    advance(0, len(sigmas))
    fits = []
    for first in range(0, len(sigmas), size):
        fits.append(run(sigmas[first : first + size]))
        advance(min(first + size, len(sigmas)), len(sigmas))
    return jax.tree.map(lambda *leaves: np.concatenate(leaves), *fits)


def _known(fits: Fit) -> Fit:
    return jax.tree.map(np.asarray, fits)
