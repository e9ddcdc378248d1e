"""The scale sweep: fits over scales σ and starts, computed in batches of σ."""

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
"""Least number of fits in a batch: enough to keep the cores busy, and done in a fraction of a second."""


class Options(NamedTuple):
    """Options of a scale sweep.

    Attributes:
        start: name of the starts, see `symjax.sweep`.
        restarts: number of starts; 1 if the name stands for a single start.
        solver: see `symjax.fit_plane`.
        continuation: see `symjax.sweep`; the sweep then does not record the start of each fit.
        seed: seed of the random starts.
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
        options: the options of the sweep.
        fractions: σ as fractions of the diagonal.
        fits: the fits, with axes σ and start.
        rank: rank by loss of the optimum that each fit reached, among those at its σ (`symjax.scale_sweep.optima`).
        best: the best fit at every σ.
        estimated: the fit of `fit_global` that estimates σ together with the plane.
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
    """Fits pairs for many σ and starts, in float64, and fits the plane with σ estimated.

    Args:
        pairs: the pairs.
        fractions: scales σ as fractions of the diagonal.
        options: the options.
        stage: function called with the name of each stage as it begins.
        advance: function called with the number of σ done and the number of all σ.

    Raises:
        SymjaxError: if the pairs or the options are invalid, see `symjax.sweep`.
    """
    sigmas = np.asarray(fractions, float) * pairs.diagonal
    if options.start in NORMALS:
        options = options._replace(restarts=1)
    fits = _fits(pairs, sigmas, options, stage, advance)
    stage("estimating sigma")
    estimated = _to_numpy(fit_global(pairs.x, pairs.y, "auto"))
    rank = np.stack(
        [
            ranks(Plane(*planes), loss, converged, centre=pairs.centre, diagonal=pairs.diagonal)
            for *planes, loss, converged in zip(*fits.plane, fits.loss, np.asarray(fits.converged), strict=True)
        ]
    )
    return ScaleSweep(pairs, options, np.asarray(fractions, float), fits, rank, best(fits), estimated)


def _fits(
    pairs: SweepPairs,
    sigmas: Float[np.ndarray, " S"],
    options: Options,
    stage: Callable[[str], None],
    advance: Callable[[int, int], None],
) -> Fit:
    """Fits in batches of equal size, so that one program is compiled for all."""
    is_single_batch = options.continuation
    parts = -(-len(sigmas) * options.restarts // SLOTS)
    size = len(sigmas) if is_single_batch else -(-len(sigmas) // min(parts, len(sigmas)))
    key = jax.random.key(options.seed) if options.start == "random" else None

    def run(batch: Float[np.ndarray, " s"]) -> Fit:
        padded = np.concatenate([batch, np.repeat(batch[-1:], size - len(batch))])
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
        without_padding: Fit = jax.tree.map(lambda leaf: leaf[: len(batch)], _to_numpy(fits))
        return without_padding

    stage("sweeping sigma")
    advance(0, len(sigmas))
    fits = []
    for first in range(0, len(sigmas), size):
        fits.append(run(sigmas[first : first + size]))
        advance(min(first + size, len(sigmas)), len(sigmas))
    joined: Fit = jax.tree.map(lambda *leaves: np.concatenate(leaves), *fits)
    return joined


def _to_numpy(fits: Fit) -> Fit:
    converted: Fit = jax.tree.map(np.asarray, fits)
    return converted
