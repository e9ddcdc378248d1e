"""What all experiments share: options, rows as CSV beside their provenance, and a table on the screen."""

import argparse
import csv
import dataclasses
import json
import os
import platform
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import Any

import symjax
from experiments.data.absence import DataAbsentError

Row = dict[str, Any]

PROJECT = Path(__file__).resolve().parents[2]
NOT_MEASURED = 3
"""Exit status of an experiment whose data is absent."""

PACKAGES = ("jax", "jaxlib", "numpy", "scipy", "optimistix", "robust-laplacian", "trimesh")


def main(
    file: str,
    doc: str | None,
    sizes: Mapping[str, Any],
    run: Callable[[Any], list[Row]],
    summary: Callable[[list[Row]], list[Row]],
    *,
    draw: Callable[[Any, list[Row], Path], None] | None = None,
    argv: Sequence[str] | None = None,
) -> None:
    """The command of an experiment: runs it, writes its files and prints its summary.

    Writes `NAME.csv` (the rows), `NAME.json` (summary and provenance), `NAME.md` (the summary as Markdown) and, with
    `draw`, `NAME.png` and `NAME.pdf`. Where its data is absent it writes nothing and exits with `NOT_MEASURED`.

    Args:
        file: `__file__` of the experiment.
        doc: its docstring, of which the first line is the help.
        sizes: configurations by the name of their size. Fields that are a number or a string become options.
        run: gives the rows of a configuration.
        summary: gives the lines of the printed table, with the paper's number or the target beside ours.
        draw: draws the rows of a configuration into a PNG file, and into a PDF beside it (`experiments.framework.figures.save`).
        argv: the command line's arguments.
    """
    name = Path(file).stem
    argv = sys.argv[1:] if argv is None else argv
    command = " ".join([f"python -m experiments.{name}", *argv])
    size, out, config = _options(name, doc or "", sizes, argv)
    started, clock = datetime.now(UTC), perf_counter()
    try:
        rows = run(config)
    except DataAbsentError as error:
        print(f"{name}: {error}", file=sys.stderr)
        sys.exit(NOT_MEASURED)
    seconds = perf_counter() - clock
    if not rows:
        print(f"{name}: NOTHING WAS MEASURED, and nothing is written", file=sys.stderr)
        sys.exit(NOT_MEASURED)
    lines = summary(rows)
    out.mkdir(parents=True, exist_ok=True)
    write_rows(rows, out / f"{name}.csv")
    about = provenance(command, config, size, started, seconds)
    about |= {"models": models(rows), "summary": lines}
    (out / f"{name}.json").write_text(json.dumps(about, indent=1, default=_plain) + "\n", encoding="utf-8")
    (out / f"{name}.md").write_text(markdown(lines) + "\n", encoding="utf-8")
    if draw is not None:
        draw(config, rows, out / f"{name}.png")
    print(f"{name} ({size}): {len(rows)} rows in {seconds:.0f} s -> {out / name}.csv")
    print(table(lines))


def _options(name: str, doc: str, sizes: Mapping[str, Any], argv: Sequence[str]) -> tuple[str, Path, Any]:
    parser = argparse.ArgumentParser(prog=f"python -m experiments.{name}", description=doc.splitlines()[0])
    parser.add_argument("--size", choices=list(sizes), default="full")
    parser.add_argument("--out", type=Path, default=PROJECT / "experiments" / "out", help="folder of the files")
    default = next(iter(sizes.values()))
    names = [f.name for f in dataclasses.fields(default) if isinstance(getattr(default, f.name), (int, float, str))]
    for field in names:
        kind = type(getattr(default, field))
        values = ", ".join(f"{getattr(config, field)} ({size})" for size, config in sizes.items())
        parser.add_argument(f"--{field.replace('_', '-')}", type=kind, help=f"by default {values}")
    given = vars(parser.parse_args(argv))
    changed = {field: given[field] for field in names if given[field] is not None}
    return given["size"], given["out"], dataclasses.replace(sizes[given["size"]], **changed)


def write_rows(rows: list[Row], path: Path) -> None:
    """Writes rows of the same columns as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def models(rows: list[Row]) -> dict[str, int]:
    """How many models of every group, or objects of every benchmark, the rows are of."""
    benchmarks = {row["benchmark"]: row["objects"] for row in rows if "objects" in row}
    if benchmarks:
        return benchmarks
    named = {(row["group"], row.get("model") or row.get("name")) for row in rows if "group" in row}
    return dict(Counter(group for group, _ in sorted(named)))


def provenance(command: str, config: Any, size: str, started: datetime, seconds: float) -> Row:
    """Where rows come from: commit, versions, machine, configuration (its seed among it), command, time."""
    return {
        "command": command,
        "size": size,
        "config": {name: _relative(value) for name, value in dataclasses.asdict(config).items()},
        "commit": _commit(),
        "versions": {"python": platform.python_version(), "symjax": symjax.__version__, **_versions()},
        "machine": {"system": platform.platform(), "cpu": _cpu(), "cores": os.cpu_count()},
        "started": started.isoformat(timespec="seconds"),
        "wall_seconds": round(seconds, 3),
    }


def _relative(value: Any) -> Any:
    """A path of this machine as seen from the project: the files are kept, and read elsewhere."""
    return os.path.relpath(value, PROJECT) if isinstance(value, str) and Path(value).is_absolute() else value


def _commit() -> str:
    """The commit, with a + where the working tree differs from it; empty outside a repository."""
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


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, "item") else str(value)


def table(lines: list[Row]) -> str:
    """Rows of the same columns as aligned text."""
    cells = [list(lines[0]), *([_text(value) for value in line.values()] for line in lines)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in cells)


def markdown(lines: list[Row]) -> str:
    """Rows of the same columns as a Markdown table."""
    cells = [list(lines[0]), ["---"] * len(lines[0]), *([_text(value) for value in line.values()] for line in lines)]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in cells)


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 1e4 else f"{value:.3e}"
    return str(value)
