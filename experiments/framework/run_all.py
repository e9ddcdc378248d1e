"""Several studies, one process after the other; one that fails does not stop the rest."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from tempfile import TemporaryDirectory
from time import perf_counter

from experiments.framework.project import PROJECT
from experiments.framework.run_study import NOT_MEASURED

CACHE = {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0", "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1"}
"""What several studies compile alike is compiled once: half of a small run is compilation."""


def run_all(names: Sequence[str], options: Sequence[str]) -> dict[str, str]:
    """Runs studies in turn, with a line each on the screen.

    Args:
        names: which, in this order.
        options: of all of them.

    Returns:
        Those that left no results, and why: "failed with status …" or "data absent".
    """
    missing = {}
    with TemporaryDirectory() as compiled:
        environment = os.environ | CACHE | {"JAX_COMPILATION_CACHE_DIR": compiled}
        for k, name in enumerate(names, start=1):
            start = perf_counter()
            outcome = _run(name, options, environment)
            if outcome:
                missing[name] = outcome
            print(f"[{k}/{len(names)}] {name}: {outcome or 'done'}, {perf_counter() - start:.0f} s", flush=True)
    return missing


def _run(name: str, options: Sequence[str], environment: Mapping[str, str]) -> str:
    """Why there are no results; empty where there are."""
    command = [sys.executable, "-m", "experiments.run", name, *options]
    # what it prints is in its files; errors and its progress bar are on the screen
    status = subprocess.run(command, cwd=PROJECT, env=environment, stdout=subprocess.DEVNULL, check=False).returncode
    return {0: "", NOT_MEASURED: "data absent"}.get(status, f"failed with status {status}")
