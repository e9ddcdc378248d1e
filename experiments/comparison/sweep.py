"""Rows, table and figure of a sweep of one corruption, for all methods."""

from pathlib import Path

from experiments.comparison import published
from experiments.comparison.curves import draw_sweep
from experiments.comparison.leaderboard import pivot, standings
from experiments.comparison.plan import Config, outcomes
from experiments.framework import figures
from experiments.framework.study import Row

MEASURES = ("hit rate", "F paper", "F", "median angle", "seconds")


def run(config: Config) -> list[Row]:
    """A line a benchmark, condition and method."""
    return standings(outcomes(config))


def summary(rows: list[Row], printed: dict[str, dict[str, float]], data: str = published.DATA) -> list[Row]:
    """Methods by conditions, and what the paper prints.

    Args:
        rows: of `run`.
        printed: the paper's figures by method and condition.
        data: that these are of.
    """
    names = list(dict.fromkeys(row["condition"] for row in rows))
    return pivot(rows, MEASURES) + published.lines(printed, names, data)


def draw(rows: list[Row], path: Path, corruption: str, printed: dict[str, dict[str, float]]) -> None:
    """F as the paper takes it, and the hit rate, which also minds the offset."""
    drawn = figures.new(13, 5)
    for axes, measure in zip(drawn.subplots(1, 2), ("F paper", "hit rate"), strict=True):
        draw_sweep(axes, rows, corruption, printed if measure == "F paper" else {}, measure)
    drawn.legend(*drawn.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figures.save(drawn, path)
