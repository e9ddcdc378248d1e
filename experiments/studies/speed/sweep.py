"""Sweeps over thousands of restarts and scales: time over that of the exponentials, memory, continuation, two devices.

The time of the exponentials is that of `exp` on a batch as wide as the solvers', times the number of passes that the
fits made. It is a lower bound on the time of the sweep. Extra memory is what the compiled program allocates in addition
to its arguments and results.
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
from experiments.studies.speed.random_starts import SweepProcess, planted, random_starts
from symjax.l2e.fit import best
from symjax.l2e.manifolds import random_points
from symjax.l2e.solvers.batched import NUM_SLOTS
from symjax.l2e.sweep import sweep

ROUNDING = 1e-9  # relative difference of losses that counts as equal
EXP_CALLS = 100


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_pairs: number of pairs.
        scales: number of scales σ, from 0.2 down to 0.02 of the object's radius.
        restarts: number of random starts at each scale.
        memory_pairs: number of pairs in the second measurement of memory.
        memory_restarts: number of starts in the second measurement of memory, at one scale.
        repeats: rounds of timing.
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
    """Returns one row per quantity."""
    with jax.enable_x64(True):
        return [*_times(config), *_memory(config), *_devices(config)]


def _row(quantity: str, value: float, target: str, *, note: str = "") -> Row:
    return {"quantity": quantity, "value": value, "target": target, "note": note}


def _times(config: Config) -> list[Row]:
    sigmas = np.geomspace(0.2, 0.02, config.scales)
    independent = random_starts(config.num_pairs, sigmas, config.restarts, config.seed)
    continued = random_starts(config.num_pairs, sigmas, config.restarts, config.seed, continuation=True)
    exponents = 10 * jax.random.uniform(jax.random.key(1), (NUM_SLOTS, config.num_pairs))
    # many in one program, so that the overhead of calling a program does not count
    exp = jax.jit(lambda e: jax.lax.fori_loop(0, EXP_CALLS, lambda _, e: jnp.exp(-e), e))
    seconds = interleaved(
        {"independent": independent, "continued": continued, "exp": lambda: exp(exponents)}, config.repeats
    )
    fits, continued_fits = independent(), continued()
    passes = float(jnp.sum(fits.num_steps + 1))
    exp_seconds = seconds["exp"] / (EXP_CALLS * NUM_SLOTS) * passes
    over_exp, over_exp_quartiles = ratio(seconds["independent"], exp_seconds)
    speed_up, speed_up_quartiles = ratio(seconds["independent"], seconds["continued"])
    worse = best(continued_fits).loss - best(fits).loss > ROUNDING * jnp.abs(best(fits).loss)
    num_worse = int(jnp.sum(continued_fits.loss > fits.loss + ROUNDING * jnp.abs(fits.loss)))
    count = fits.loss.size
    return [
        _row(
            f"seconds of {count} fits",
            float(np.median(seconds["independent"])),
            "",
            note=f"{passes / count:.3g} passes a fit",
        ),
        _row(f"{count} fits: time / time of exp", over_exp, "<= 5", note=f"quartiles {over_exp_quartiles}"),
        _row("share of fits that converged", float(jnp.mean(fits.converged)), ""),
        _row("continuation: speed-up", speed_up, ">= 8", note=f"quartiles {speed_up_quartiles}"),
        _row(
            "continuation: scales with a worse best loss",
            float(jnp.sum(worse)),
            "0",
            note=f"worse fits: {num_worse} of {count}",
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
        note = f"and {needed.output_size_in_bytes / 2**20:.3g} of results"
        name = f"extra MiB, {scales * restarts} fits, {num_pairs} pairs"
        rows.append(_row(name, needed.temp_size_in_bytes / 2**20, target, note=note))
    return rows


def _devices(config: Config) -> list[Row]:
    processes = [SweepProcess(count, config.num_pairs, config.scales, config.restarts) for count in (1, 2)]
    try:
        seconds = np.array([[process.seconds() for process in processes] for _ in range(config.repeats)])
    finally:
        for process in processes:
            process.close()
    speed_up, quartiles = ratio(seconds[:, 0], seconds[:, 1])
    return [_row("two host devices: speed-up over one", speed_up, ">= 1.6", note=f"quartiles {quartiles}")]


STUDY = Study("speed_sweep", __doc__, SIZES, run, data=PLANTED)
