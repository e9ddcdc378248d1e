"""Thousands of restarts and scales: time over the cost of the exponentials, memory, continuation, and two devices.

The floor is what the exponentials alone would take: `exp` of a batch as wide as the solvers', times the passes that the
fits took. Extra memory is what the compiled program asks for beside its arguments and answers.
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
from experiments.studies.speed.random_starts import Devices, planted, random_starts
from symjax.l2e.fit import best
from symjax.l2e.manifolds import random_points
from symjax.l2e.solvers.batched import NUM_SLOTS
from symjax.l2e.sweep import sweep

ROUNDING = 1e-9  # relative, of a loss
FLOOR_CALLS = 100


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_pairs: pairs.
        scales: number of scales σ, from 0.2 down to 0.02 of the object's radius.
        restarts: random starts at each.
        memory_pairs: pairs of the second measurement of memory.
        memory_restarts: starts of it, at one scale.
        repeats: rounds.
        seed: seed of pairs and starts.
    """

    num_pairs: int = 1000
    scales: int = 8
    restarts: int = 4096
    memory_pairs: int = 10_000
    memory_restarts: int = 1024
    repeats: int = 5
    seed: int = 0


SIZES = {"full": Config(), "small": Config(scales=2, restarts=40, memory_pairs=1500, memory_restarts=40, repeats=1)}


def run(config: Config) -> list[Row]:
    """One row a figure."""
    with jax.enable_x64(True):
        return [*_times(config), *_memory(config), *_devices(config)]


def _row(figure: str, value: float, target: str, *, note: str = "") -> Row:
    return {"figure": figure, "value": value, "target": target, "note": note}


def _times(config: Config) -> list[Row]:
    sigmas = np.geomspace(0.2, 0.02, config.scales)
    independent = random_starts(config.num_pairs, sigmas, config.restarts, config.seed)
    continued = random_starts(config.num_pairs, sigmas, config.restarts, config.seed, continuation=True)
    exponents = 10 * jax.random.uniform(jax.random.key(1), (NUM_SLOTS, config.num_pairs))
    # one after the other in one program: what it costs to call a program is not counted
    exp = jax.jit(lambda e: jax.lax.fori_loop(0, FLOOR_CALLS, lambda _, e: jnp.exp(-e), e))
    seconds = interleaved(
        {"independent": independent, "continued": continued, "exp": lambda: exp(exponents)}, config.repeats
    )
    alone, followed = independent(), continued()
    passes = float(jnp.sum(alone.num_steps + 1))
    floor = seconds["exp"] / (FLOOR_CALLS * NUM_SLOTS) * passes
    over, quartiles = ratio(seconds["independent"], floor)
    cheaper, spread = ratio(seconds["independent"], seconds["continued"])
    worse = best(followed).loss - best(alone).loss
    count = alone.loss.size
    return [
        _row(
            f"seconds of {count} fits",
            float(np.median(seconds["independent"])),
            "",
            note=f"{passes / count:.3g} passes a fit",
        ),
        _row(f"{count} fits: time over the floor", over, "<= 5", note=f"quartiles {quartiles}"),
        _row("fits that converged", float(jnp.mean(alone.converged)), ""),
        _row("continuation: times cheaper", cheaper, ">= 8", note=f"quartiles {spread}"),
        _row(
            "continuation: scales at which its best loss is worse",
            float(jnp.sum(worse > ROUNDING * jnp.abs(best(alone).loss))),
            "0",
            note=f"fits worse: {int(jnp.sum(followed.loss > alone.loss + ROUNDING * jnp.abs(alone.loss)))} of {count}",
        ),
    ]


def _memory(config: Config) -> list[Row]:
    cases = (
        (config.num_pairs, config.scales, config.restarts, "<= 64"),
        (config.memory_pairs, 1, config.memory_restarts, "<= 16"),
    )
    rows = []
    for num_pairs, scales, restarts, target in cases:
        pairs = planted(num_pairs, config.seed)
        sigmas = jnp.geomspace(0.2, 0.02, scales)
        starts = random_points(jax.random.key(config.seed), restarts)
        arguments = (jnp.asarray(pairs.x), jnp.asarray(pairs.y), sigmas, starts)
        needed: Any = jax.jit(sweep).lower(*arguments).compile().memory_analysis()
        note = f"and {needed.output_size_in_bytes / 2**20:.3g} of answers"
        name = f"extra MiB, {scales * restarts} fits, {num_pairs} pairs"
        rows.append(_row(name, needed.temp_size_in_bytes / 2**20, target, note=note))
    return rows


def _devices(config: Config) -> list[Row]:
    processes = [Devices(count, config.num_pairs, config.scales, config.restarts) for count in (1, 2)]
    try:
        seconds = np.array([[process.seconds() for process in processes] for _ in range(config.repeats)])
    finally:
        for process in processes:
            process.close()
    times, quartiles = ratio(seconds[:, 0], seconds[:, 1])
    return [_row("two host devices: times faster than one", times, ">= 1.6", note=f"quartiles {quartiles}")]


STUDY = Study("speed_sweep", __doc__, SIZES, run, data=PLANTED)
