"""Runs one study, writes its rows, table, figure and provenance, and prints the table."""

import json
import shlex
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from time import perf_counter
from typing import Any

from experiments.framework.absence import DataAbsentError
from experiments.framework.options import PROGRAM, parse
from experiments.framework.provenance import count_models, provenance
from experiments.framework.study import Study
from experiments.framework.tables import markdown, text_table, write_rows

FAILED = 1
"""Exit status of a small run that would replace the results of a full one."""

NOT_MEASURED = 3
"""Exit status of a study whose data is absent, or that has no rows."""


def run_study(study: Study, argv: Sequence[str]) -> int:
    """Runs a study, writes its files and prints its summary.

    Writes `NAME.csv` (the rows), `NAME.json` (summary and provenance), `NAME.md` (the summary as Markdown, with the
    notes) and, if the study has a figure, `NAME.png` and `NAME.pdf`. Writes nothing if the data is absent, if there are
    no rows, or if the run is small and the folder holds the results of a full run.

    Args:
        study: study to run.
        argv: command-line options of the study.

    Returns:
        The exit status.
    """
    name = study.name
    size, out, config = parse(study, argv)
    if size != "full" and _size(out / f"{name}.json") == "full":
        print(f"{name}: {out} HOLDS THE RESULTS OF A FULL RUN; a small run needs another --out", file=sys.stderr)
        return FAILED
    started, clock = datetime.now(UTC), perf_counter()
    try:
        rows = study.run(config)
    except DataAbsentError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return NOT_MEASURED
    seconds = perf_counter() - clock
    if not rows:
        print(f"{name}: NOTHING WAS MEASURED, nothing is written", file=sys.stderr)
        return NOT_MEASURED
    lines = study.summary(rows)
    out.mkdir(parents=True, exist_ok=True)
    write_rows(rows, out / f"{name}.csv")
    about = provenance(f"{PROGRAM} {shlex.join([name, *argv])}", config, size, started, seconds)
    about |= {"models": count_models(rows), "summary": lines}
    (out / f"{name}.json").write_text(json.dumps(about, indent=1, default=_json_value) + "\n", encoding="utf-8")
    texts = [markdown(lines), *([study.notes(rows)] if study.notes else [])]
    (out / f"{name}.md").write_text("\n\n".join(texts) + "\n", encoding="utf-8")
    if study.draw is not None:
        study.draw(config, rows, out / f"{name}.png")
    print(f"{name} ({size}): {len(rows)} rows in {seconds:.0f} s -> {out / name}.csv")
    print(text_table(lines))
    return 0


def _size(path: Path) -> str:
    """Returns the size of the run whose provenance is in a file; empty if the file does not exist."""
    return json.loads(path.read_text(encoding="utf-8")).get("size", "") if path.is_file() else ""


def _json_value(value: Any) -> Any:
    """Converts a NumPy or JAX scalar to a number, and anything else to text."""
    return value.item() if hasattr(value, "item") else str(value)
