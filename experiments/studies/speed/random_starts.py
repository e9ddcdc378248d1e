"""A sweep of planted pairs from random starts, here or in a process of its own on several devices of the CPU.

The process sweeps once for every line that it reads and prints the seconds that it took. `Devices` starts it, with the
number of pairs, of scales and of starts as its arguments.
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


def planted(num_pairs: int, seed: int) -> PlantedPairs:
    """The pairs."""
    return planted_pairs(np.random.default_rng(seed), num_pairs, OUTLIERS)


def random_starts(
    num_pairs: int, sigmas: Float[np.ndarray, " S"], restarts: int, seed: int, **options: Any
) -> Callable[[], Fit]:
    """A sweep of random starts, ready to run."""
    pairs = planted(num_pairs, seed)
    x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)
    return partial(sweep, x, y, sigmas, random_points(jax.random.key(seed), restarts), **options)


class Devices:
    """Such a process, started and warm."""

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
        """Seconds that one sweep takes."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        print(file=self._process.stdin, flush=True)
        return float(self._process.stdout.readline())

    def close(self) -> None:
        """Ends the process."""
        self._process.communicate()


def main(num_pairs: int, scales: int, restarts: int) -> None:
    """The process."""
    jax.config.update("jax_enable_x64", True)
    swept = random_starts(num_pairs, np.geomspace(0.2, 0.02, scales), restarts, seed=0)
    for _ in sys.stdin:
        start = perf_counter()
        jax.block_until_ready(swept())
        print(perf_counter() - start, flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
