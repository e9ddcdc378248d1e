"""Fits under JAX's transformations: jit, vmap, precisions, derivatives of the answer, compilations.

Each measured value stands beside its target, as in `checks`.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

import symjax
from experiments.data.descriptions import PLANTED
from experiments.framework.study import Study
from experiments.framework.tables import Row
from experiments.studies.estimator.checks import SIZES, Config, planted, row
from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry import distance
from symjax.geometry.directions import fibonacci

COMPILED = "/jax/core/compile/backend_compile_duration"


def run(config: Config) -> list[Row]:
    """One row a check; under float64."""
    with jax.enable_x64(True):
        return [row for check in (transformations, precision, derivatives, compilations) for row in check(config)]


def transformations(config: Config) -> Iterator[Row]:
    """Fits under jit and vmap are those without."""
    p = planted(config)
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    starts = jnp.asarray(fibonacci(8))

    def fit(v0: Float[Array, "3"]) -> Float[Array, "4"]:
        plane = symjax.fit_plane(x, y, config.sigma, v0).plane
        return jnp.append(plane.normal, plane.offset)

    alone = jnp.stack([fit(v0) for v0 in starts])
    yield row("jit = no jit: largest difference", jnp.abs(jax.jit(fit)(starts[0]) - alone[0]).max(), 1e-12)
    yield row("vmap = Python loop: largest difference", jnp.abs(jax.vmap(fit)(starts) - alone).max(), 1e-12)
    swept = symjax.sweep(x, y, [config.sigma], starts).plane
    swept_rows = jnp.concatenate([swept.normal[0], swept.offset[0][:, None]], axis=1)
    yield row("sweep = Python loop: largest difference", jnp.abs(swept_rows - alone).max(), 1e-12)


def precision(config: Config) -> Iterator[Row]:
    """float32 against float64."""
    p = planted(config)
    double, single = (
        symjax.fit_plane(jnp.asarray(p.x, dtype), jnp.asarray(p.y, dtype), config.sigma, jnp.asarray(p.normal, dtype))
        for dtype in (jnp.float64, jnp.float32)
    )
    apart = distance.deviation_angle(np.asarray(double.plane.normal), np.asarray(single.plane.normal, float))
    note = f"{single.plane.normal.dtype}: {single.message}"
    yield row("float32 against float64, degrees", float(apart), 1e-3, note=note)


def derivatives(config: Config) -> Iterator[Row]:
    """Implicit derivatives of the answer against central differences; forward, reverse, vmap, jit."""
    p = planted(config)
    rng = np.random.default_rng(config.seed + 2)
    given = {"x": p.x, "y": p.y, "weights": rng.uniform(0.5, 1.5, len(p.x)), "sigma": np.array(config.sigma)}
    values = {name: jnp.asarray(value) for name, value in given.items()}
    probe = jnp.asarray(rng.normal(size=4))

    def answer(values: dict[str, Array]) -> Float[Array, ""]:
        x, y, sigma, weights = (values[name] for name in ("x", "y", "sigma", "weights"))
        plane = symjax.fit_plane(x, y, sigma, p.normal, weights=weights, tol=1e-12).plane
        return jnp.sum(probe * jnp.append(plane.normal, plane.offset))

    slopes = jax.jit(jax.grad(answer))(values)
    compiled = jax.jit(answer)
    jvp = jax.jit(lambda values, tangent: jax.jvp(answer, (values,), (tangent,))[1])
    worst = 0.0
    for name, value in values.items():
        direction = jnp.asarray(rng.normal(size=value.shape))
        step = 1e-5
        ends = [compiled({**values, name: value + side * step * direction}) for side in (1, -1)]
        central = (ends[0] - ends[1]) / (2 * step)
        reverse = jnp.sum(slopes[name] * direction)
        error = abs(reverse - central) / jnp.maximum(1, abs(central))
        yield row(f"implicit derivative in {name} against central differences", error, 1e-6)
        tangent = {**jax.tree.map(jnp.zeros_like, values), name: direction}
        forward = jvp(values, tangent)
        worst = max(worst, float(abs(forward - reverse) / jnp.maximum(1, abs(reverse))))
    yield row("jvp against jit(grad), relative", worst, 1e-9)
    stacked = jax.tree.map(lambda leaf: jnp.stack([leaf, 1.01 * leaf]), values)
    together = jax.jit(jax.vmap(jax.grad(answer)))(stacked)["x"][0]
    yield row("vmap(grad) against jit(grad): largest difference", jnp.abs(together - slopes["x"]).max(), 1e-9)


@contextmanager
def _counted(counts: list[str]) -> Iterator[None]:
    """Appends to the list at every compilation of a sweep in the block."""
    listening = [True]

    def listen(event: str, duration_secs: float, **about: Any) -> None:
        if listening[0] and event == COMPILED and "sweep" in str(about.get("fun_name")):
            counts.append(event)

    jax.monitoring.register_event_duration_secs_listener(listen)
    try:
        yield
    finally:
        listening[0] = False


def compilations(config: Config) -> Iterator[Row]:
    """Compilations of a whole sweep, and of its repetition on other pairs, scales and starts."""
    # a number of pairs that nothing else has, or it would be compiled already
    p = planted_pairs(np.random.default_rng(config.seed), config.num_pairs + 7, 0.5, "thin")
    starts = jnp.asarray(fibonacci(20))
    inputs = [(p.x, p.y, [0.03, 0.05, 0.1], starts), (p.x + 1, p.y + 1, [0.02, 0.04, 0.08], -starts)]
    as_arrays = [tuple(jax.block_until_ready(jnp.asarray(value)) for value in case) for case in inputs]
    for case, name, relation in zip(as_arrays, ("a sweep of 3 x 20 fits", "its repetition"), (1, 0), strict=True):
        counts: list[str] = []
        with _counted(counts):
            jax.block_until_ready(symjax.sweep(*case).loss)
        yield row(f"compilations of {name} on other pairs", len(counts), relation)


STUDY = Study("transformations", __doc__, SIZES, run, lambda rows: rows, data=PLANTED)
