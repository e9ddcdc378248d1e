"""Derivatives of the fit: their accuracy, and their cost relative to the fit itself.

The derivatives are those of the public functions, compiled: of a random combination of normal, offset, σ and inlier
fraction, with respect to the points, the weights and σ. They are compared with central differences; forward mode and
vmap are compared with reverse mode.
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
"""Step of the central differences, which are of fourth order."""

Arguments = dict[str, Array]
"""Points x and y, weights and sigma."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_pairs: number of pairs.
        outliers: share of outlier pairs.
        sigma: scale σ of the residual.
        fits: names of the fits, separated by commas; empty is all.
        repeats: rounds of timing.
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
    """Returns one row per fit."""
    with jax.enable_x64(True):
        return list(_rows(config))


def _fits(config: Config, normal: Float[np.ndarray, " 3"]) -> dict[str, Callable[[Arguments], Fit]]:
    def fit(function: Callable[..., Fit], values: Arguments, *start: Any, sigma: Any = None, **options: Any) -> Fit:
        scale = values["sigma"] if sigma is None else sigma
        return function(values["x"], values["y"], scale, *start, weights=values["weights"], **options)

    def with_solver(solver: str) -> Callable[[Arguments], Fit]:
        tol = 1e-8 if solver == "alternating" else 1e-12
        return lambda values: fit(fit_plane, values, normal, solver=solver, tol=tol, max_steps=500)

    fits = {f"fit_plane {solver}": with_solver(solver) for solver in SOLVER_NAMES}
    fits["fit_plane from -v"] = lambda values: fit(fit_plane, values, -normal, tol=1e-12)
    fits["fit_global"] = lambda values: fit(fit_global, values, tol=1e-12)
    fits["fit_global with sigma auto"] = lambda values: fit(fit_global, values, sigma=AUTO, tol=1e-12)
    return fits


def _rows(config: Config) -> Iterator[Row]:
    pairs = planted_pairs(np.random.default_rng(config.seed), config.num_pairs, config.outliers)
    rng = np.random.default_rng(config.seed + 1)
    weights = rng.uniform(0.5, 1.5, config.num_pairs)
    arguments = {"x": pairs.x, "y": pairs.y, "weights": weights, "sigma": config.sigma}
    values = {name: jnp.asarray(value) for name, value in arguments.items()}
    probe = jnp.asarray(rng.normal(size=6))
    directions = {name: jnp.asarray(rng.normal(size=value.shape)) for name, value in values.items()}
    fits = _fits(config, pairs.normal)
    for name in split_names(config.fits, fits) if config.fits else fits:
        fit = fits[name]

        def fun(values: Arguments, fit: Callable[[Arguments], Fit] = fit) -> Float[Array, ""]:
            result = fit(values)
            scalars = jnp.stack([jnp.asarray(result.plane.offset), result.sigma, result.inlier_fraction])
            return jnp.sum(probe * jnp.concatenate([jnp.asarray(result.plane.normal), scalars]))

        yield _row(name, fun, values, directions, config.repeats)


def _row(
    name: str, fun: Callable[[Arguments], Float[Array, ""]], values: Arguments, directions: Arguments, repeats: int
) -> Row:
    """Compares the derivatives of a function of the fit, and times them."""
    value, value_and_grad = jax.jit(fun), jax.jit(jax.value_and_grad(fun))
    grad = value_and_grad(values)[1]
    largest = 0.0
    for part, direction in directions.items():
        f = [float(value({**values, part: values[part] + side * STEP * direction})) for side in (-2, -1, 1, 2)]
        central = (8 * (f[2] - f[1]) - (f[3] - f[0])) / (12 * STEP)
        largest = max(largest, abs(float(jnp.sum(grad[part] * direction)) - central) / max(1, abs(central)))
    jvp = jax.jit(lambda values, directions: jax.jvp(fun, (values,), (directions,))[1])(values, directions)
    total = sum(float(jnp.sum(grad[part] * directions[part])) for part in values)
    stacked = jax.tree.map(lambda leaf: jnp.stack([leaf, 1.001 * leaf]), values)
    batched = jax.jit(jax.vmap(jax.grad(fun)))(stacked)["x"][0]
    cases = {"fit": partial(value, values), "value and gradient": partial(value_and_grad, values)}
    seconds = interleaved(cases, repeats)
    cost, quartiles = ratio(seconds["value and gradient"], seconds["fit"])
    return {
        "fit": name,
        "against central differences": largest,
        "jvp against grad": abs(float(jvp) - total) / max(1, abs(total)),
        "vmap(grad) against grad": float(jnp.abs(batched - grad["x"]).max()),
        "fit, ms": float(np.median(seconds["fit"])) * 1e3,
        "value and gradient / fit": cost,
        "quartiles": quartiles,
        "target": "<= 1e-6, <= 2.2 x",
    }


STUDY = Study("gradient", __doc__, SIZES, run, data=PLANTED)
