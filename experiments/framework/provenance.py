"""Provenance of results: command, configuration, commit, versions, machine and time; and how many models they cover."""

import dataclasses
import os
import platform
import subprocess
from collections import Counter
from datetime import datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import symjax
from experiments.framework.project import PROJECT
from experiments.framework.tables import Row

PACKAGES = ("jax", "jaxlib", "numpy", "scipy", "optimistix", "robust-laplacian", "trimesh")


def provenance(command: str, config: Any, size: str, started: datetime, seconds: float) -> Row:
    """Collects the provenance of results; the seed is part of the configuration.

    Args:
        command: command line that produced the results.
        config: configuration, a dataclass.
        size: "full" or "small", or another description of how much was run.
        started: start of the run.
        seconds: wall-clock time of the run.
    """
    return {
        "command": command,
        "size": size,
        "config": {name: _relative(value) for name, value in dataclasses.asdict(config).items()},
        "commit": current_commit(),
        "versions": {"python": platform.python_version(), "symjax": symjax.__version__, **_versions()},
        "machine": {"system": platform.platform(), "cpu": _cpu(), "cores": os.cpu_count()},
        "started": started.isoformat(timespec="seconds"),
        "wall_seconds": round(seconds, 3),
    }


def count_models(rows: list[Row]) -> dict[str, int]:
    """Counts the objects that rows cover, by benchmark; or, if rows name no benchmark, the models by group."""
    benchmarks = {row["benchmark"]: row["objects"] for row in rows if "objects" in row}
    if benchmarks:
        return benchmarks
    named = {(row["group"], row.get("model") or row.get("name")) for row in rows if "group" in row}
    return dict(Counter(group for group, _ in sorted(named)))


def _relative(value: Any) -> Any:
    """Makes an absolute path relative to the checkout, because the files are kept and read on other machines."""
    return os.path.relpath(value, PROJECT) if isinstance(value, str) and Path(value).is_absolute() else value


def current_commit() -> str:
    """Returns the commit, with a + if the working tree differs from it; empty outside a repository."""
    try:
        head, changes = (
            subprocess.run(
                ["git", "-C", str(PROJECT), *command], capture_output=True, text=True, check=True
            ).stdout.strip()
            for command in (["rev-parse", "HEAD"], ["status", "--porcelain"])
        )
    except (OSError, subprocess.CalledProcessError):
        return ""
    return head + ("+" if changes else "")


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "absent"
    return found


def _cpu() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor()
