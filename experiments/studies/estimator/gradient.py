"""The derivative of the answer: right, and what it costs beside the fit itself.

Everything is taken through the public functions, compiled: the derivative of a random combination of the normal and the
offset in the points, the weights and σ.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from experiments.data import PLANTED
from experiments.framework.interleaved import interleaved, ratio
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.fit import Fit
from symjax.l2e.fit_global import fit_global
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.pairs.arguments import AUTO
from symjax.l2e.solvers.names import SOLVER_NAMES

STEP = 1e-4
"""Of central differences of the fourth order."""

Given = dict[str, Array]


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_pairs: pairs.
        outliers: share of outliers.
        sigma: scale σ.
        fits: whose derivative is taken, separated by commas; empty is all.
        repeats: rounds.
        seed: seed of the pairs.
    """

    num_pairs: int = 1000
    outliers: float = 0.5
    sigma: float = 0.05
    fits: str = ""
    repeats: int = 25
    seed: int = 0


SIZES = {"full": Config(), "small": Config(num_pairs=100, fits="fit_plane newton,fit_global", repeats=1)}


def run(config: Config) -> list[Row]:
    """One row a fit and question."""
    with jax.enable_x64(True):
        return list(_rows(config))


def _fits(config: Config, normal: Float[np.ndarray, " 3"]) -> dict[str, Callable[[Given], Fit]]:
    def fit(function: Callable[..., Fit], given: Given, *start: Any, sigma: Any = None, **options: Any) -> Fit:
        scale = given["sigma"] if sigma is None else sigma
        return function(given["x"], given["y"], scale, *start, weights=given["weights"], **options)

    def by(solver: str) -> Callable[[Given], Fit]:
        tol = 1e-8 if solver == "alternating" else 1e-12
        return lambda given: fit(fit_plane, given, normal, solver=solver, tol=tol, max_steps=500)

    named = {f"fit_plane {solver}": by(solver) for solver in SOLVER_NAMES}
    named["fit_plane from -v"] = lambda given: fit(fit_plane, given, -normal, tol=1e-12)
    named["fit_global"] = lambda given: fit(fit_global, given, tol=1e-12)
    named["fit_global with sigma auto"] = lambda given: fit(fit_global, given, sigma=AUTO, tol=1e-12)
    return named


def _rows(config: Config) -> Iterator[Row]:
    pairs = planted_pairs(np.random.default_rng(config.seed), config.num_pairs, config.outliers)
    rng = np.random.default_rng(config.seed + 1)
    given = {"x": pairs.x, "y": pairs.y, "weights": rng.uniform(0.5, 1.5, config.num_pairs), "sigma": config.sigma}
    values = {name: jnp.asarray(value) for name, value in given.items()}
    probe = jnp.asarray(rng.normal(size=6))
    directions = {name: jnp.asarray(rng.normal(size=value.shape)) for name, value in values.items()}
    fits = _fits(config, pairs.normal)
    for name in split_names(config.fits, fits) if config.fits else fits:
        fit = fits[name]

        def answer(given: Given, fit: Callable[[Given], Fit] = fit) -> Float[Array, ""]:
            found = fit(given)
            rest = jnp.stack([jnp.asarray(found.plane.offset), found.sigma, found.inlier_fraction])
            return jnp.sum(probe * jnp.concatenate([jnp.asarray(found.plane.normal), rest]))

        yield from _checked(name, answer, values, directions, config.repeats)


def _checked(
    name: str, answer: Callable[[Given], Float[Array, ""]], values: Given, directions: Given, repeats: int
) -> Iterator[Row]:
    """Reverse mode against central differences and against forward mode, vmap(grad) against grad, and the cost."""
    forward, both = jax.jit(answer), jax.jit(jax.value_and_grad(answer))
    slopes = both(values)[1]
    worst = 0.0
    for part, direction in directions.items():
        ends = [float(forward({**values, part: values[part] + side * STEP * direction})) for side in (-2, -1, 1, 2)]
        central = (8 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12 * STEP)
        worst = max(worst, abs(float(jnp.sum(slopes[part] * direction)) - central) / max(1, abs(central)))
    jvp = jax.jit(lambda values, directions: jax.jvp(answer, (values,), (directions,))[1])(values, directions)
    total = sum(float(jnp.sum(slopes[part] * directions[part])) for part in values)
    stacked = jax.tree.map(lambda leaf: jnp.stack([leaf, 1.001 * leaf]), values)
    together = jax.jit(jax.vmap(jax.grad(answer)))(stacked)["x"][0]
    seconds = interleaved({"fit": partial(forward, values), "value and gradient": partial(both, values)}, repeats)
    cost, quartiles = ratio(seconds["value and gradient"], seconds["fit"])
    yield {
        "fit": name,
        "against central differences": worst,
        "jvp against grad": abs(float(jvp) - total) / max(1, abs(total)),
        "vmap(grad) against grad": float(jnp.abs(together - slopes["x"]).max()),
        "fit, ms": float(np.median(seconds["fit"])) * 1e3,
        "value and gradient: x the fit": cost,
        "quartiles": quartiles,
        "target": "<= 1e-6, <= 2.2 x",
    }


STUDY = Study("gradient", __doc__, SIZES, run, data=PLANTED)
