"""The curves of the arena: precision against recall, and F against the share of outliers or of missing points."""

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
    "score": "falling score of the method, all planes, within 5° and 1 % of the diagonal",
    "best": "the same of the best plane alone",
    "thresholds": "rising t_a and t_d of Funk, all planes that are held",
    "paper": "rising t_a, the best plane alone: as the paper takes it, precision is recall",
}
"""What a curve of precision and recall runs over, by its name in the rows."""


def precision_recall(rows: Sequence[Row]) -> list[Row]:
    """The points of all curves of rows under one condition.

    Returns:
        A line a point: benchmark, method, sweep, where on it (score, or degrees of t_a), precision and recall.
    """
    lines: list[Row] = []
    for (benchmark, method), of_one in grouped(rows, "benchmark", "method").items():
        points: list[tuple[str, float, float, float]] = []
        for name, most in (("score", None), ("best", 1)):
            curve = score_curve.curve([prediction(row, most) for row in of_one])
            points += [(name, *point) for point in zip(*(column.tolist() for column in curve), strict=True)]
        for name, column in (("thresholds", "funk"), ("paper", "funk_paper")):
            points += [(name, t_a, at.precision, at.recall) for t_a, at in enumerate(tallies(of_one, column))]
        about = {"benchmark": title(benchmark), "condition": of_one[0]["condition"], "method": method}
        names = ("sweep", "at", "precision", "recall")
        lines += [about | dict(zip(names, point, strict=True)) for point in points]
    return lines


def style(method: str) -> dict[str, Any]:
    """The same colour and marker for a method in every figure; ours is thick."""
    k = list(ENTRIES).index(method)
    line = {"color": f"C{k % 10}", "linestyle": ("-", "--")[k // 10], "linewidth": 2.8 if method == OURS else 1.2}
    return line | {"label": ENTRIES[method].title}


def draw_precision_recall(axes: "Axes", lines: Sequence[Row], sweep: str) -> None:
    """One kind of curve of all methods on the first benchmark."""
    first = lines[0]["benchmark"]
    shown = (line for line in lines if (line["benchmark"], line["sweep"]) == (first, sweep))
    for method, curve in grouped(shown, "method").items():
        points = [(line["recall"], line["precision"]) for line in curve]
        axes.plot(*np.array(points, float).reshape(-1, 2).T, **style(method))
    axes.set(xlabel="recall", ylabel="precision", xlim=(-0.02, 1.02), ylim=(-0.02, 1.02))
    axes.set_title(f"{first}: {SWEEPS[sweep]}", fontsize=8)
    axes.grid(alpha=0.3)


def shares(conditions: Iterable[str], corruption: str) -> dict[str, float]:
    """Percent of outliers, or of missing points, of those conditions that have nothing else; the clean one has 0."""
    percent = {
        name: 100.0 * SWEEP_CONDITIONS[name].get(corruption, 0.0)
        for name in conditions
        if not set(SWEEP_CONDITIONS[name]) - {corruption}
    }
    return dict(sorted(percent.items(), key=lambda entry: entry[1]))


def draw_sweep(
    axes: "Axes", lines: Sequence[Row], corruption: str, printed: Mapping[str, Mapping[str, float]], measure: str
) -> None:
    """A measure against the share of a corruption, on the first benchmark; what the paper prints is black.

    Args:
        axes: to draw on.
        lines: of `leaderboard`.
        corruption: "outliers" or "missing".
        printed: the paper's figures by method and condition.
        measure: of `leaderboard.MEASURES`.
    """
    first = lines[0]["benchmark"]
    at = shares(dict.fromkeys(line["condition"] for line in lines), corruption)
    for method, of_method in grouped(grouped(lines, "benchmark")[first], "method").items():
        of_one = {line["condition"]: line[measure] for line in of_method}
        here = [name for name in at if name in of_one]
        axes.plot([at[name] for name in here], [of_one[name] for name in here], marker=".", **style(method))
    for k, (method, figures) in enumerate(printed.items()):
        places = shares(figures, corruption)
        axes.plot(
            list(places.values()), [figures[name] for name in places], f"k{'-:'[k % 2]}", marker="x", linewidth=1,
            label=f"{method}, printed (other data)",
        )  # fmt: skip
    axes.set(xlabel=f"{corruption}, %", ylabel=measure, ylim=(-0.02, 1.02))
    axes.set_title(f"{first}: {MEASURES[measure].title}", fontsize=8)
    axes.grid(alpha=0.3)
