"""Time of value, gradient and Hessian of the objective for a batch of planes, over the time of its exponentials.

The naive baseline is `symjax.l2e.objective.log_objective`, which computes the residuals directly, under value_and_grad
and vmap. The other cases are the functions that the solvers use.
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
from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.manifolds import random_points
from symjax.l2e.objective import log_objective
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.solvers.batched import NUM_SLOTS


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_pairs: number of pairs.
        planes: number of planes in a batch.
        repeats: rounds of timing.
        sigma: scale σ of the residual.
        seed: seed of pairs and planes.
    """

    num_pairs: int = 1000
    planes: int = 1024
    repeats: int = 150
    sigma: float = 0.1
    seed: int = 0


SIZES = {"full": Config(), "small": Config(planes=32, repeats=3)}


def run(config: Config) -> list[Row]:
    """Returns one row per precision and case."""
    rows = []
    for dtype in ("float64", "float32"):
        with jax.enable_x64(dtype == "float64"):
            cases = _cases(config, dtype)
            seconds = interleaved(cases, config.repeats)
            residuals = config.num_pairs * config.planes
            for name, times in seconds.items():
                nanoseconds = float(np.median(times)) * 1e9 / residuals
                row = {"precision": dtype, "case": name, "ns per pair and plane": nanoseconds}
                over_exp, speed_up = ratio(times, seconds["exp alone"]), ratio(seconds["naive"], times)
                row |= dict(zip(("time / time of exp", "its quartiles"), over_exp, strict=True))
                rows.append(row | dict(zip(("speed-up over naive", "quartiles"), speed_up, strict=True)))
    return rows


def _cases(config: Config, dtype: str) -> dict[str, Callable[[], Any]]:
    pairs = planted_pairs(np.random.default_rng(config.seed), config.num_pairs, 0.5, "thin")
    x, y = (jnp.asarray(end, dtype) for end in (pairs.x, pairs.y))
    normalised = normalise_pairs(x, y, jnp.ones(config.num_pairs, dtype))
    sigma = jnp.asarray(config.sigma, dtype) / normalised.to_given.scale
    normals = random_points(jax.random.key(config.seed), config.planes).astype(dtype)
    offsets = 0.1 * jax.random.normal(jax.random.key(config.seed + 1), (config.planes, 1), dtype)
    planes = jnp.concatenate([normals, offsets], axis=1)
    criterion = Criterion(features(normalised.x, normalised.y), sigma)
    exponents = -10 * jax.random.uniform(jax.random.key(2), (config.planes, config.num_pairs), dtype)

    naive = jax.jit(
        jax.vmap(jax.value_and_grad(lambda z: log_objective(z[:3], z[3], sigma, normalised.x, normalised.y)))
    )
    fast = jax.jit(jax.vmap(jax.value_and_grad(criterion.value)))
    expand = jax.jit(jax.vmap(criterion.expand))
    # as in the solvers: the working set of a few hundred planes stays in the cache of a core
    value_and_grad = jax.value_and_grad(criterion.value)
    in_batches = jax.jit(lambda planes: jax.lax.map(value_and_grad, planes, batch_size=min(NUM_SLOTS, config.planes)))
    exp = jax.jit(jnp.exp)
    return {
        "exp alone": lambda: exp(exponents),
        "naive": lambda: naive(planes),
        "value and gradient": lambda: fast(planes),
        f"value and gradient, {NUM_SLOTS} planes at a time": lambda: in_batches(planes),
        "value, gradient and Hessian": lambda: expand(planes),
    }


def summary(rows: list[Row]) -> list[Row]:
    """Adds the targets to the rows."""
    targets = {
        "value and gradient": "<= 2 x exp, >= 20 x naive",
        "value, gradient and Hessian": "<= 3 x exp",
    }
    return [{**row, "target": targets.get(row["case"], "")} for row in rows]


STUDY = Study("speed_objective", __doc__, SIZES, run, summary, data=PLANTED)
