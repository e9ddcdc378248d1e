"""Precision against recall of all methods: as a threshold on their scores falls, and as Funk's thresholds rise.

The paper's figure is on Funk 2017 and prints no numbers. It puts all centres at the mean of the cloud and scores one
answer against one truth a shape, so that its curve is a diagonal by definition: the last sweep here. The table has the
largest F of each sweep, and the F at 5°. It goes on from the results of `experiments.studies.paper.arena`.
"""

from collections.abc import Sequence
from pathlib import Path

from experiments.baselines.registry import ENTRIES
from experiments.comparison.curves import SWEEPS, draw_precision_recall, precision_recall
from experiments.comparison.leaderboard import DEGREES
from experiments.comparison.plan import Config, outcomes, sizes
from experiments.comparison.plan import main as command
from experiments.framework import figures
from experiments.framework.study import Row

SIZES = sizes("clean", "clean")


def run(config: Config) -> list[Row]:
    """A line a point of a curve."""
    rows = outcomes(config)
    conditions = dict.fromkeys(row["condition"] for row in rows)
    return [line for name in conditions for line in precision_recall([row for row in rows if row["condition"] == name])]


def summary(rows: list[Row]) -> list[Row]:
    """A line a benchmark, condition and method: the largest F of each sweep, and that of Funk's at 5°."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row["benchmark"], row["condition"], row["method"]), []).append(row)
    return [
        {"data": benchmark, "condition": condition, "method": ENTRIES[method].title}
        | {f"largest F, {sweep}": max((_f(r) for r in of_one if r["sweep"] == sweep), default=0.0) for sweep in SWEEPS}
        | {f"F at {DEGREES}°, {sweep}": _at(of_one, sweep) for sweep in ("thresholds", "paper")}
        | {"paper": "curve only, other data"}
        for (benchmark, condition, method), of_one in groups.items()
    ]


def _f(row: Row) -> float:
    both = row["precision"] + row["recall"]
    return 2 * row["precision"] * row["recall"] / both if both else 0.0


def _at(rows: list[Row], sweep: str) -> float:
    return next(_f(row) for row in rows if row["sweep"] == sweep and row["at"] == DEGREES)


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """The three sweeps that are no diagonal by definition."""
    first = [row for row in rows if row["condition"] == rows[0]["condition"]]
    drawn = figures.new(18, 5)
    for axes, sweep in zip(drawn.subplots(1, 3), ("score", "best", "thresholds"), strict=True):
        draw_precision_recall(axes, first, sweep)
    drawn.legend(*drawn.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figures.save(drawn, path)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    command(__file__, __doc__, SIZES, run, summary, draw=draw, argv=argv)


if __name__ == "__main__":
    main()
