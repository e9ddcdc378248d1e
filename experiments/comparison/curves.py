"""Curves of the comparison: precision against recall, and F against the share of outliers or of missing points."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from experiments.baselines.registry import ENTRIES, OURS
from experiments.comparison.leaderboard import MEASURES, prediction, tallies, title
from experiments.data.corruptions import SWEEP_CONDITIONS
from experiments.framework.tables import Row, grouped
from experiments.metrics import score_curve

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SWEEPS = {
    "score": "falling score threshold, all planes, within 5° and 1 % of the diagonal",
    "best": "falling score threshold, best plane only, within 5° and 1 % of the diagonal",
    "thresholds": "rising t_a and t_d of Funk, all accepted planes",
    "paper": "rising t_a, best plane only, as in the paper: precision equals recall",
}
"""The parameter that varies along a curve of precision and recall, by the name of the curve in the rows."""


def precision_recall(rows: Sequence[Row]) -> list[Row]:
    """Computes the curves of all methods, from rows under one condition.

    Returns:
        One line per point: benchmark, method, sweep, the parameter of the sweep (a score, or t_a in degrees), precision
        and recall.
    """
    lines: list[Row] = []
    for (benchmark, method), group in grouped(rows, "benchmark", "method").items():
        points: list[tuple[str, float, float, float]] = []
        for name, most in (("score", None), ("best", 1)):
            curve = score_curve.curve([prediction(row, most) for row in group])
            points += [(name, *point) for point in zip(*(column.tolist() for column in curve), strict=True)]
        for name, column in (("thresholds", "funk"), ("paper", "funk_paper")):
            points += [(name, t_a, tally.precision, tally.recall) for t_a, tally in enumerate(tallies(group, column))]
        about = {"benchmark": title(benchmark), "condition": group[0]["condition"], "method": method}
        names = ("sweep", "at", "precision", "recall")
        lines += [about | dict(zip(names, point, strict=True)) for point in points]
    return lines


def style(method: str) -> dict[str, Any]:
    """Returns the line style of a method, the same in every figure; symjax's line is thick."""
    k = list(ENTRIES).index(method)
    line = {"color": f"C{k % 10}", "linestyle": ("-", "--")[k // 10], "linewidth": 2.8 if method == OURS else 1.2}
    return line | {"label": ENTRIES[method].title}


def draw_precision_recall(axes: "Axes", lines: Sequence[Row], sweep: str) -> None:
    """Draws one kind of curve for all methods on the first benchmark."""
    first = lines[0]["benchmark"]
    shown = (line for line in lines if (line["benchmark"], line["sweep"]) == (first, sweep))
    for method, curve in grouped(shown, "method").items():
        points = [(line["recall"], line["precision"]) for line in curve]
        axes.plot(*np.array(points, float).reshape(-1, 2).T, **style(method))
    axes.set(xlabel="recall", ylabel="precision", xlim=(-0.02, 1.02), ylim=(-0.02, 1.02))
    axes.set_title(f"{first}: {SWEEPS[sweep]}", fontsize=8)
    axes.grid(alpha=0.3)


def shares(conditions: Iterable[str], corruption: str) -> dict[str, float]:
    """Returns the percentage of outliers, or of missing points, of the conditions that have no other corruption.

    The clean condition has 0.
    """
    percent = {
        name: 100.0 * SWEEP_CONDITIONS[name].get(corruption, 0.0)
        for name in conditions
        if not set(SWEEP_CONDITIONS[name]) - {corruption}
    }
    return dict(sorted(percent.items(), key=lambda entry: entry[1]))


def draw_sweep(
    axes: "Axes", lines: Sequence[Row], corruption: str, paper: Mapping[str, Mapping[str, float]], measure: str
) -> None:
    """Draws a measure against the share of a corruption, on the first benchmark, with the paper's numbers in black.

    Args:
        axes: axes to draw on.
        lines: lines of `leaderboard`.
        corruption: "outliers" or "missing".
        paper: the paper's numbers by method and condition.
        measure: a key of `leaderboard.MEASURES`.
    """
    first = lines[0]["benchmark"]
    percent = shares(dict.fromkeys(line["condition"] for line in lines), corruption)
    for method, group in grouped(grouped(lines, "benchmark")[first], "method").items():
        values = {line["condition"]: line[measure] for line in group}
        names = [name for name in percent if name in values]
        axes.plot([percent[name] for name in names], [values[name] for name in names], marker=".", **style(method))
    for k, (method, in_paper) in enumerate(paper.items()):
        percent = shares(in_paper, corruption)
        axes.plot(
            list(percent.values()), [in_paper[name] for name in percent], f"k{'-:'[k % 2]}", marker="x", linewidth=1,
            label=f"{method}, published (other data)",
        )  # fmt: skip
    axes.set(xlabel=f"{corruption}, %", ylabel=measure, ylim=(-0.02, 1.02))
    axes.set_title(f"{first}: {MEASURES[measure].title}", fontsize=8)
    axes.grid(alpha=0.3)
