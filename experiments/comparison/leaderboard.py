"""The measures of each method on a benchmark under a condition, and the table of methods by conditions."""

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
"""Largest angle of a correct plane."""

GTE_UNIT, SDE_UNIT = 1e-2, 1e-4
"""Units in which published tables print GTE and SDE."""

MEASURES = {
    "hit rate": Measure(f"best plane within {DEGREES}° and 2 % of the diagonal"),
    "F paper": Measure(f"F by the paper's protocol: best plane within {DEGREES}°, any offset"),
    "F": Measure(f"F of Funk, all accepted planes: t_a = {DEGREES}°, t_d = 2/9 s"),
    "F score": Measure("F at the best threshold on the method's score, all planes: 5°, 1 %"),
    "F score, best": Measure("F at the best threshold on the method's score, best plane only: 5°, 1 %"),
    "area": Measure("area under hit rate over angle, to 45°"),
    "median angle": Measure("median angle, °", False),
    "median offset": Measure("median offset error, % of the diagonal", False),
    "GTE": Measure("mean GTE, 1e-2", False),
    "GTE squared": Measure("mean squared GTE, 1e-2", False),
    "SDE": Measure("mean of the positive SDE, 1e-4", False, 0.1),
    "seconds": Measure("median seconds", False),
}
"""The measures by which methods are compared. No answer counts as 90° and one diagonal; the means of GTE and SDE are
taken over the answers. SDE is measured on points: two samples of a surface determine it to about 0.1."""

FURTHER_MEASURES = {
    f"hit rate {degrees:g}": Measure(f"within {degrees:g}° and 2 %") for degrees in hits.ANGLES if degrees != DEGREES
} | TRACKS
"""Hit rates at other angles, and the measures of other publications."""


def prediction(row: Row, most: int | None = None) -> Prediction:
    """Rebuilds the prediction of a row, with its first `most` planes or, by default, all.

    The case has one point, the mean of the cloud, which is all that the metrics of planes need.
    """
    table = np.array(row["planes"], float).reshape(-1, 5)[:most]
    truths = tuple(Plane(np.array(t[:3], float), np.asarray(t[3], float)) for t in row["truths"])
    case = Case(row["name"], row["group"], np.array([row["centre"]]), truths, row["diagonal"], row["seed"])
    return Prediction(Ranking(table[:, :3], table[:, 3], table[:, 4]), case)


def accepted_planes(row: Row) -> Prediction:
    """Rebuilds the prediction of a row with the planes that the method accepts as mirror planes."""
    every = prediction(row)
    accepted = np.array(row["accepted"], bool)
    return every._replace(ranking=Ranking(*(column[accepted] for column in every.ranking)))


def tallies(rows: Sequence[Row], column: str) -> list[Tally]:
    """Pools the counts of all rows at each of Funk's thresholds, one per degree of t_a.

    Args:
        rows: rows of one method.
        column: "funk" for all accepted planes, or "funk_paper" for the best plane alone against one true plane.
    """
    if column == "funk_paper":
        counts = [(int(bool(row["planes"])), 1) for row in rows]
    else:
        counts = [(sum(row["accepted"]), len(row["truths"])) for row in rows]
    swept = zip(*(row[column] for row in rows), strict=True)
    return [
        pooled(Tally(hit, answers, truths) for hit, (answers, truths) in zip(step, counts, strict=True))
        for step in swept
    ]


def measures_of(rows: Sequence[Row]) -> Row:
    """Computes `MEASURES` and `FURTHER_MEASURES`, and counts the objects, the answers and the planes found.

    Args:
        rows: rows of one method on one benchmark under one condition.
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
        **tracks([accepted_planes(row) for row in rows]),
    }


def best_f(rows: Sequence[Row], most: int | None = None) -> float:
    """Returns the largest F along the curve of precision and recall; 0 if no plane is correct.

    Args:
        rows: rows of one method.
        most: number of planes of each shape that count; None is all.
    """
    curve = score_curve.curve([prediction(row, most) for row in rows])
    both = curve.precision + curve.recall
    return float((2 * curve.precision * curve.recall / np.where(both > 0, both, 1)).max(initial=0.0))


def _mean(rows: Sequence[Row], column: str, unit: float) -> float | str:
    values = [row[column] for row in rows if row[column] is not None]
    return float(np.mean(values)) / unit if values else ""


def leaderboard(rows: Iterable[Row]) -> list[Row]:
    """Returns one line per benchmark, condition and method, in the order of the rows."""
    groups = grouped(rows, "benchmark", "condition", "method")
    return [
        {
            **{"benchmark": title(benchmark), "condition": condition, "method": method},
            **{"title": ENTRIES[method].title, "points": group[0]["num_points"]},
            **measures_of(group),
        }
        for (benchmark, condition, method), group in groups.items()
    ]


def title(benchmark: str) -> str:
    """Returns the title of a benchmark in the tables."""
    return TITLES.get(benchmark, benchmark)


def pivot(lines: Sequence[Row], measures: Iterable[str]) -> list[Row]:
    """Rearranges the leaderboard as methods by conditions, one block per benchmark and measure."""
    conditions = list(dict.fromkeys(line["condition"] for line in lines))
    cell = {(line["benchmark"], line["title"], line["condition"]): line for line in lines}
    return [
        {"data": benchmark, "measure": MEASURES[measure].title, "method": method}
        | {name: cell.get((benchmark, method, name), {}).get(measure, "") for name in conditions}
        for benchmark in dict.fromkeys(line["benchmark"] for line in lines)
        for measure in measures
        for method in dict.fromkeys(line["title"] for line in lines)
    ]
