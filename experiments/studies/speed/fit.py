"""`fit_global` beside restarts of other solvers: how long each takes to the best plane, and whether it is the same.

The naive baseline is our Riemannian BFGS on the residuals as they are written, from even directions under one vmap, as
`sweep` was at first: once from the planes that all others start from, and once from their normals, with the search for
their offsets that it had. All have the same tolerance and limit on steps. A positive "log f above
it" would be a better optimum than that of `fit_global`.
"""

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
from symjax.l2e.fit import best
from symjax.l2e.fit_global import fit_global
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.starts.hypotheses import offset_search
from symjax.l2e.sweep import sweep

OURS = "fit_global"
NAIVE = "naive: Riemannian BFGS, vmapped"
WHOLE = "naive, from normals alone"
TARGETS = {
    (WHOLE, 1000): ">= 30 x fit_global (stretch 50)",
    (WHOLE, 10_000): ">= 150 x fit_global (stretch 400)",
    (NAIVE, 1000): ">= 30 x fit_global (stretch 50)",
    (NAIVE, 10_000): ">= 150 x fit_global (stretch 400)",
    ("optimistix BFGS, vmapped", 1000): ">= 20 x",
    ("pymanopt ConjugateGradient, a loop", 1000): "the better of pymanopt's >= 150 x",
    ("pymanopt TrustRegions, a loop", 1000): "the better of pymanopt's >= 150 x",
}


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        sizes: numbers of pairs, separated by commas; other packages run at the first alone.
        outliers: share of outlier pairs.
        restarts: starts of all but fit_global.
        sigma: scale σ.
        repeats: rounds.
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
    """One row a size and solver."""
    with jax.enable_x64(True):
        sizes = [int(size) for size in config.sizes.split(",")]
        return [row for size in sizes for row in _rows(config, size, everyone=size == sizes[0])]


def _rows(config: Config, num_pairs: int, *, everyone: bool) -> list[Row]:
    pairs = planted_pairs(np.random.default_rng(config.seed), num_pairs, config.outliers)
    x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)
    normalised = normalise_pairs(x, y, jnp.ones(num_pairs))
    sigma = jnp.asarray(config.sigma / normalised.to_given.scale)
    normals = fibonacci(config.restarts)
    starts = jax.jit(jax.vmap(lambda v: offset_search(normalised)(v, sigma)))(normals)
    task = external_solvers.Task(normalised, sigma, starts, config.max_steps, config.tol)
    options: dict[str, Any] = {"max_steps": config.max_steps, "tol": config.tol}
    fits = {
        OURS: lambda: fit_global(x, y, config.sigma, **options),
        "sweep, Newton": lambda: best(sweep(x, y, [config.sigma], normals, **options)),
        "sweep, Riemannian BFGS": lambda: best(sweep(x, y, [config.sigma], normals, solver="rbfgs", **options)),
    }
    lowest = {NAIVE: external_solvers.naive(task), WHOLE: external_solvers.naive_from_normals(task)} | (
        external_solvers.available(task) if everyone else {}
    )
    seconds = interleaved({**fits, **lowest}, config.repeats)
    # ψ = σ²(1 − log mean exp(−f/2σ²)), and the loss is a constant minus f of Eq. 5, which is that mean times a constant
    constant, factor = (4 * np.pi * config.sigma**2) ** -1.5, 2 * (2 * np.pi * config.sigma**2) ** -1.5
    log_f = {name: float(np.log((constant - np.ravel(fit().loss)[0]) / factor)) for name, fit in fits.items()}
    log_f |= {name: 1 - float(run() / sigma**2) for name, run in lowest.items()}
    return [
        {
            **{"pairs": num_pairs, "solver": name, "starts": 1 if name == OURS else config.restarts},
            "ms": float(np.median(times)) * 1e3,
            **dict(zip(("x fit_global", "quartiles"), ratio(times, seconds[OURS]), strict=True)),
            "log f above it": log_f[name] - log_f[OURS],
            "target": TARGETS.get((name, num_pairs), ""),
        }
        for name, times in seconds.items()
    ]


STUDY = Study("speed_fit", __doc__, SIZES, run, data=PLANTED)
