"""Runs several studies, each in its own process; a study that fails does not stop the others."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from tempfile import TemporaryDirectory
from time import perf_counter

from experiments.framework.project import PROJECT
from experiments.framework.run_study import NOT_MEASURED

CACHE = {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0", "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1"}
"""Makes JAX cache every compiled function, so that studies share them: half of a small run is compilation."""


def run_all(names: Sequence[str], options: Sequence[str]) -> dict[str, str]:
    """Runs studies in turn and prints one line for each.

    Args:
        names: names of the studies, in the order in which they run.
        options: command-line options, passed to every study.

    Returns:
        The reason why a study left no results, by its name: "failed with status …" or "data absent".
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
    """Runs a study; returns why it left no results, or "" if it did."""
    command = [sys.executable, "-m", "experiments.run", name, *options]
    # the printed table is also in the files; errors and the progress bar go to stderr, which stays visible
    status = subprocess.run(command, cwd=PROJECT, env=environment, stdout=subprocess.DEVNULL, check=False).returncode
    return {0: "", NOT_MEASURED: "data absent"}.get(status, f"failed with status {status}")
