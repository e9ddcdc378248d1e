"""All experiments, one process after the other, and the page of their tables and figures.

One that fails does not stop the rest; the status is then 1. The page stands beside the folder of the results, or in it
if that is not the usual one, and holds whatever results are there: a run of some keeps the sections of the others.
"""

import argparse
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from experiments.data.corruptions import chosen
from experiments.framework.catalogue import CONTENTS, script
from experiments.framework.page import page
from experiments.framework.study import NOT_MEASURED, PROJECT

OUT = PROJECT / "experiments" / "out"

CACHE = {"JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0", "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1"}
"""What several experiments compile alike is compiled once: half of a small run is compilation."""


def run(names: Sequence[str], size: str, out: Path) -> dict[str, str]:
    """Runs experiments in turn, with a line each on the screen.

    Args:
        names: which, in this order.
        size: "small" or "full".
        out: folder of their files.

    Returns:
        Those that left no results, and why: "failed", "data absent" or "no such script".
    """
    missing = {}
    with TemporaryDirectory() as compiled:
        environment = os.environ | CACHE | {"JAX_COMPILATION_CACHE_DIR": compiled}
        for k, name in enumerate(names, start=1):
            start = perf_counter()
            outcome = _run(name, size, out, environment)
            if outcome:
                missing[name] = outcome
            print(f"[{k}/{len(names)}] {name}: {outcome or 'done'}, {perf_counter() - start:.0f} s", flush=True)
    return missing


def _run(name: str, size: str, out: Path, environment: Mapping[str, str]) -> str:
    """Why there are no results; empty where there are."""
    if not script(name).is_file():
        return "no such script"
    command = [sys.executable, "-m", f"experiments.{name}", "--size", size]
    if out != OUT:
        command += ["--out", str(out)]
    # what it prints is in its files; errors and its progress bar are on the screen
    status = subprocess.run(command, cwd=PROJECT, env=environment, stdout=subprocess.DEVNULL, check=False).returncode
    return {0: "", NOT_MEASURED: "data absent"}.get(status, f"failed with status {status}")


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    parser = argparse.ArgumentParser(
        prog="python -m experiments.framework.run_all", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--size", choices=["small", "full"], required=True, help="small takes a quarter of an hour")
    parser.add_argument("--out", type=Path, default=OUT, help="folder of the files")
    parser.add_argument("--only", default=",".join(CONTENTS), help="which, separated by commas")
    given = parser.parse_args(argv)
    try:
        names = chosen(given.only, CONTENTS)
    except ValueError as error:
        parser.error(str(error))
    out = given.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    start = perf_counter()
    missing = run(names, given.size, out)
    folder = out.parent if out == OUT else out
    (folder / "README.md").write_text(page(out, folder, missing), encoding="utf-8")
    print(f"{len(names) - len(missing)} of {len(names)} in {perf_counter() - start:.0f} s -> {folder / 'README.md'}")
    for name, outcome in missing.items():
        print(f"{name}: {outcome}")
    if any(outcome.startswith("failed") for outcome in missing.values()):
        sys.exit(1)


if __name__ == "__main__":
    main()
