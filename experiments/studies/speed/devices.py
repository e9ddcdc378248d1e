"""A process that sweeps on several devices of the CPU.

For every line that it reads it sweeps once and prints the seconds that it took. `Devices` starts it, with the number of
devices, of pairs, of scales and of starts as its arguments.
"""

import os
import subprocess
import sys
from time import perf_counter

from experiments.framework.project import PROJECT


class Devices:
    """Such a process, started and warm."""

    def __init__(self, count: int, num_pairs: int, scales: int, restarts: int) -> None:
        command = [
            sys.executable,
            "-m",
            "experiments.studies.speed.devices",
            *map(str, (count, num_pairs, scales, restarts)),
        ]
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
    import jax
    import numpy as np

    from experiments.studies.speed.random_starts import random_starts

    jax.config.update("jax_enable_x64", True)
    sweep = random_starts(num_pairs, np.geomspace(0.2, 0.02, scales), restarts, seed=0)
    for _ in sys.stdin:
        start = perf_counter()
        jax.block_until_ready(sweep())
        print(perf_counter() - start, flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[2:]))
