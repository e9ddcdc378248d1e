"""How a method stands on a benchmark under a condition, and the table of all methods by condition."""

from collections.abc import Iterable, Sequence

import numpy as np

from experiments.baselines.registry import ENTRIES
from experiments.comparison.objects import TITLES
from experiments.comparison.tracks import TRACKS, Measure, tracks
from experiments.data.cases import Case
from experiments.framework.tables import Row, grouped
from experiments.metrics import hits, score_curve
from experiments.metrics.deviation import Deviation
from experiments.metrics.matching import Tally, pooled
from experiments.metrics.prediction import Prediction
from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane

DEGREES = 5
"""Largest angle of a right answer."""

GTE_UNIT, SDE_UNIT = 1e-2, 1e-4
"""What published tables print GTE and SDE in."""


MEASURES = {
    "hit rate": Measure(f"best plane within {DEGREES}° and 2 % of the diagonal"),
    "F paper": Measure(f"F as the paper takes it: best plane within {DEGREES}°, any offset"),
    "F": Measure(f"F of Funk, all planes that are held: t_a = {DEGREES}°, t_d = 2/9 s"),
    "F score": Measure("F at the best threshold of the method's own score, all planes: 5°, 1 %"),
    "F score, best": Measure("F at the best threshold of the score, best plane alone: 5°, 1 %"),
    "area": Measure("area under hit rate over angle, to 45°"),
    "median angle": Measure("median angle, °", False),
    "median offset": Measure("median offset error, % of the diagonal", False),
    "GTE": Measure("mean GTE, 1e-2", False),
    "GTE squared": Measure("mean squared GTE, 1e-2", False),
    "SDE": Measure("mean SDE, of those above 0, 1e-4", False, 0.1),
    "seconds": Measure("median seconds", False),
}
"""The columns that methods are compared in. What gave no answer counts as 90° and a whole diagonal; means of GTE and
SDE are over answers. SDE is that of points, which two samples of a surface tell to about 0.1."""

OTHERS = {
    f"hit rate {degrees:g}": Measure(f"within {degrees:g}° and 2 %") for degrees in hits.ANGLES if degrees != DEGREES
} | TRACKS
"""Further columns: hit rates at other angles, and the measures of other publications."""


def prediction(row: Row, most: int | None = None) -> Prediction:
    """The first planes, by default all, and the truths of a row; the case has the mean of its points in their place."""
    table = np.array(row["planes"], float).reshape(-1, 5)[:most]
    truths = tuple(Plane(np.array(t[:3]), np.asarray(t[3])) for t in row["truths"])
    case = Case(row["name"], row["group"], np.array([row["centre"]]), truths, row["diagonal"], row["seed"])
    return Prediction(Ranking(table[:, :3], table[:, 3], table[:, 4]), case)


def held(row: Row) -> Prediction:
    """The planes of a row that the method takes for mirror planes, and its truths."""
    every = prediction(row)
    kept = np.array(row["held"], bool)
    return every._replace(ranking=Ranking(*(column[kept] for column in every.ranking)))


def tallies(rows: Sequence[Row], column: str) -> list[Tally]:
    """Pooled counts at Funk's thresholds, a degree of t_a each.

    Args:
        rows: of one method.
        column: "funk", of all planes that are held, or "funk_paper", of the best plane alone against one truth.
    """
    if column == "funk_paper":
        counts = [(int(bool(row["planes"])), 1) for row in rows]
    else:
        counts = [(sum(row["held"]), len(row["truths"])) for row in rows]
    swept = zip(*(row[column] for row in rows), strict=True)
    return [
        pooled(Tally(hit, answers, truths) for hit, (answers, truths) in zip(step, counts, strict=True))
        for step in swept
    ]


def measures_of(rows: Sequence[Row]) -> Row:
    """The figures of `MEASURES` and `OTHERS`, and how many objects and answers they are of.

    Args:
        rows: of one method on one benchmark under one condition.
    """
    deviations = [Deviation(row["angle"], row["offset_error"]) for row in rows]
    angles, offsets = np.array(deviations, float).T
    rates = hits.hit_rates(deviations)
    return {
        "objects": len(rows),
        "answered": sum(bool(row["planes"]) for row in rows),
        "found": sum(row["found"] for row in rows),
        "hit rate": rates[float(DEGREES)],
        **{f"hit rate {degrees:g}": rate for degrees, rate in rates.items() if degrees != DEGREES},
        "F paper": tallies(rows, "funk_paper")[DEGREES].f,
        "F": tallies(rows, "funk")[DEGREES].f,
        "F score": best_f(rows),
        "F score, best": best_f(rows, 1),
        "area": hits.area(deviations),
        "median angle": float(np.median(angles)),
        "median offset": 100 * float(np.median(offsets)),
        "GTE": _mean(rows, "gte", GTE_UNIT),
        "GTE squared": _mean(rows, "gte_squared", GTE_UNIT),
        "SDE": _mean([row for row in rows if row["sde"] and row["sde"] > 0], "sde", SDE_UNIT),
        "seconds": float(np.median([row["seconds"] for row in rows])),
        **tracks([held(row) for row in rows]),
    }


def best_f(rows: Sequence[Row], most: int | None = None) -> float:
    """The largest F along the curve of precision and recall, of so many planes a shape; 0 where nothing was right."""
    curve = score_curve.curve([prediction(row, most) for row in rows])
    both = curve.precision + curve.recall
    return float((2 * curve.precision * curve.recall / np.where(both > 0, both, 1)).max(initial=0.0))


def _mean(rows: Sequence[Row], column: str, unit: float) -> float | str:
    values = [row[column] for row in rows if row[column] is not None]
    return float(np.mean(values)) / unit if values else ""


def leaderboard(rows: Iterable[Row]) -> list[Row]:
    """A line a benchmark, condition and method, in the order in which they come."""
    groups = grouped(rows, "benchmark", "condition", "method")
    return [
        {
            **{"benchmark": title(benchmark), "condition": condition, "method": method},
            **{"title": ENTRIES[method].title, "points": of_one[0]["num_points"]},
            **measures_of(of_one),
        }
        for (benchmark, condition, method), of_one in groups.items()
    ]


def title(benchmark: str) -> str:
    """What tables call a benchmark."""
    return TITLES.get(benchmark, benchmark)


def pivot(lines: Sequence[Row], measures: Iterable[str]) -> list[Row]:
    """The leaderboard as methods by conditions, a block a benchmark and measure."""
    conditions = list(dict.fromkeys(line["condition"] for line in lines))
    cell = {(line["benchmark"], line["title"], line["condition"]): line for line in lines}
    return [
        {"data": benchmark, "measure": MEASURES[measure].title, "method": method}
        | {name: cell.get((benchmark, method, name), {}).get(measure, "") for name in conditions}
        for benchmark in dict.fromkeys(line["benchmark"] for line in lines)
        for measure in measures
        for method in dict.fromkeys(line["title"] for line in lines)
    ]
