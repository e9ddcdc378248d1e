"""Time of `fit_global` and of restarts of other solvers to the best plane, and the values that they reach.

The naive baseline is symjax's Riemannian BFGS on the residuals, computed directly, from evenly spread directions under
one vmap, like the first version of `sweep`. It runs twice: from the planes from which all other solvers start, and from
the normals of these planes, with the search for the offset of that first version. All solvers have the same tolerance
and limit on steps. A positive difference in log f would mean that a solver found a better optimum than `fit_global`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from experiments.data import PLANTED
from experiments.framework.interleaved import interleaved, ratio
from experiments.framework.study import Study
from experiments.framework.tables import Row
from experiments.studies.speed import external_solvers
from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import fibonacci
from symjax.l2e.fit import Fit, best
from symjax.l2e.fit_global import fit_global
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.starts.hypotheses import offset_search
from symjax.l2e.sweep import sweep

OURS = "fit_global"
NAIVE = "naive: Riemannian BFGS, vmapped"
NAIVE_FROM_NORMALS = "naive, from normals only"
TARGETS = {
    (NAIVE_FROM_NORMALS, 1000): ">= 30 x fit_global (stretch 50)",
    (NAIVE_FROM_NORMALS, 10_000): ">= 150 x fit_global (stretch 400)",
    (NAIVE, 1000): ">= 30 x fit_global (stretch 50)",
    (NAIVE, 10_000): ">= 150 x fit_global (stretch 400)",
    ("optimistix BFGS, vmapped", 1000): ">= 20 x",
    ("pymanopt ConjugateGradient, a loop", 1000): "the better of pymanopt's >= 150 x",
    ("pymanopt TrustRegions, a loop", 1000): "the better of pymanopt's >= 150 x",
}


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        sizes: numbers of pairs, separated by commas; the solvers of other packages run at the first only.
        outliers: share of outlier pairs.
        restarts: number of starts, except for `fit_global`.
        sigma: scale σ of the residual.
        repeats: rounds of timing.
        max_steps: limit on the steps.
        tol: bound on the gradient.
        seed: seed of the pairs.
    """

    sizes: str = "1000,10000"
    outliers: float = 0.8
    restarts: int = 64
    sigma: float = 0.03
    repeats: int = 5
    max_steps: int = 200
    tol: float = 1e-8
    seed: int = 0


SIZES = {"full": Config(), "small": Config(sizes="200", restarts=4, repeats=1)}


def run(config: Config) -> list[Row]:
    """Returns one row per number of pairs and solver."""
    with jax.enable_x64(True):
        sizes = [int(size) for size in config.sizes.split(",")]
        return [row for size in sizes for row in _rows(config, size, other_packages=size == sizes[0])]


def _rows(config: Config, num_pairs: int, *, other_packages: bool) -> list[Row]:
    pairs = planted_pairs(np.random.default_rng(config.seed), num_pairs, config.outliers)
    x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)
    normalised = normalise_pairs(x, y, jnp.ones(num_pairs))
    sigma = jnp.asarray(config.sigma / normalised.to_given.scale)
    normals = fibonacci(config.restarts)
    starts = jax.jit(jax.vmap(lambda v: offset_search(normalised)(v, sigma)))(normals)
    task = external_solvers.Task(normalised, sigma, starts, config.max_steps, config.tol)
    options: dict[str, Any] = {"max_steps": config.max_steps, "tol": config.tol}
    fits: dict[str, Callable[[], Fit]] = {
        OURS: lambda: fit_global(x, y, config.sigma, **options),
        "sweep, Newton": lambda: best(sweep(x, y, [config.sigma], normals, **options)),
        "sweep, Riemannian BFGS": lambda: best(sweep(x, y, [config.sigma], normals, solver="rbfgs", **options)),
    }
    lowest = {NAIVE: external_solvers.naive(task), NAIVE_FROM_NORMALS: external_solvers.naive_from_normals(task)}
    if other_packages:
        lowest |= external_solvers.available(task)
    seconds = interleaved({**fits, **lowest}, config.repeats)
    # ψ = σ²(1 − log mean exp(−f/2σ²)); the loss is a constant minus f of Eq. 5, which is this mean times a constant
    constant, factor = (4 * np.pi * config.sigma**2) ** -1.5, 2 * (2 * np.pi * config.sigma**2) ** -1.5
    log_f = {name: float(np.log((constant - np.ravel(fit().loss)[0]) / factor)) for name, fit in fits.items()}
    log_f |= {name: 1 - float(run() / sigma**2) for name, run in lowest.items()}
    return [
        {
            **{"pairs": num_pairs, "solver": name, "starts": 1 if name == OURS else config.restarts},
            "ms": float(np.median(times)) * 1e3,
            **dict(zip(("x fit_global", "quartiles"), ratio(times, seconds[OURS]), strict=True)),
            "log f minus that of fit_global": log_f[name] - log_f[OURS],
            "target": TARGETS.get((name, num_pairs), ""),
        }
        for name, times in seconds.items()
    ]


STUDY = Study("speed_fit", __doc__, SIZES, run, data=PLANTED)
