"""A sweep of planted pairs from random starts, in this process or in a separate one with several CPU devices.

The separate process, which `SweepProcess` starts, takes the numbers of pairs, scales and starts as arguments. For every
line that it reads, it sweeps once and prints the time in seconds.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from experiments.framework.project import PROJECT
from symjax.datasets.planted_pairs import PlantedPairs, planted_pairs
from symjax.l2e.fit import Fit
from symjax.l2e.manifolds import random_points
from symjax.l2e.sweep import sweep

OUTLIERS = 0.8

wait: Callable[[Fit], Fit] = jax.block_until_ready
"""JAX gives it no types."""


def planted(num_pairs: int, seed: int) -> PlantedPairs:
    """Returns the planted pairs of the sweep, with 80 % outliers."""
    return planted_pairs(np.random.default_rng(seed), num_pairs, OUTLIERS)


def random_starts(
    num_pairs: int, sigmas: Float[np.ndarray, " S"], restarts: int, seed: int, **options: Any
) -> Callable[[], Fit]:
    """Prepares a sweep from random starts; calling the result runs it."""
    pairs = planted(num_pairs, seed)
    x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)
    return partial(sweep, x, y, sigmas, random_points(jax.random.key(seed), restarts), **options)


class SweepProcess:
    """A process with several CPU devices that sweeps on request; its programs are compiled when it is created."""

    def __init__(self, count: int, num_pairs: int, scales: int, restarts: int) -> None:
        command = [sys.executable, "-m", "experiments.studies.speed.random_starts"]
        command += map(str, (num_pairs, scales, restarts))
        flags = f"{os.environ.get('XLA_FLAGS', '')} --xla_force_host_platform_device_count={count}"
        environment = os.environ | {"XLA_FLAGS": flags, "JAX_PLATFORMS": "cpu"}
        self._process = subprocess.Popen(
            command, cwd=PROJECT, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        self.seconds()  # compiles

    def seconds(self) -> float:
        """Runs one sweep and returns its time in seconds."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(file=self._process.stdin, flush=True)
        return float(self._process.stdout.readline())

    def close(self) -> None:
        """Ends the process."""
        self._process.communicate()


def main(num_pairs: int, scales: int, restarts: int) -> None:
    """Runs the separate process."""
    with jax.enable_x64(True):
        run = random_starts(num_pairs, np.geomspace(0.2, 0.02, scales), restarts, seed=0)
        for _ in sys.stdin:
            start = perf_counter()
            wait(run())
            print(perf_counter() - start, flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
