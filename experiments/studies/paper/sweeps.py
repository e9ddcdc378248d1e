"""The paper's tables and figures that the arena's results hold: five studies of the same tasks.

They differ in their conditions, in the columns of their table and in what they draw. All go on from the results of the
study `arena` in the same folder.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from experiments.baselines.registry import ENTRIES
from experiments.comparison import plan, published
from experiments.comparison.curves import SWEEPS, draw_precision_recall, draw_sweep, precision_recall
from experiments.comparison.leaderboard import DEGREES, leaderboard, pivot
from experiments.comparison.plan import Config, outcomes
from experiments.data import BENCHMARKS
from experiments.framework import figures
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped

MEASURES = ("hit rate", "F paper", "F", "median angle", "seconds")

GTE_SDE_COLUMNS = {"GTE squared": "mean squared GTE, 1e-2", "GTE": "mean GTE, 1e-2", "SDE": "mean SDE, 1e-4"}


@dataclass(frozen=True)
class Sweep:
    """A sweep of one corruption.

    Attributes:
        printed: the paper's F by method and condition.
        data: that these are of.
        corruption: "outliers" or "missing": what the figure runs over; empty where there is no figure.
    """

    printed: Mapping[str, Mapping[str, float]]
    data: str = published.DATA
    corruption: str = ""

    def summary(self, rows: list[Row]) -> list[Row]:
        """Methods by conditions, a block a measure, and what the paper prints."""
        names = list(dict.fromkeys(row["condition"] for row in rows))
        return pivot(rows, MEASURES) + published.lines(self.printed, names, self.data)

    def draw(self, config: Config, rows: list[Row], path: Path) -> None:
        """F as the paper takes it, and the hit rate, which also minds the offset."""
        drawn = figures.new(13, 5)
        for axes, measure in zip(drawn.subplots(1, 2), ("F paper", "hit rate"), strict=True):
            draw_sweep(axes, rows, self.corruption, self.printed if measure == "F paper" else {}, measure)
        drawn.legend(*drawn.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
        figures.save(drawn, path)


def lines_of_methods(config: Config) -> list[Row]:
    """A line a benchmark, condition and method."""
    return leaderboard(outcomes(config))


def points_of_curves(config: Config) -> list[Row]:
    """A line a point of a curve of precision and recall."""
    return [line for rows in grouped(outcomes(config), "condition").values() for line in precision_recall(rows)]


def largest_f(rows: list[Row]) -> list[Row]:
    """A line a benchmark, condition and method: the largest F of each sweep, and that of Funk's at 5°."""
    groups = grouped(rows, "benchmark", "condition", "method")
    return [
        {"data": benchmark, "condition": condition, "method": ENTRIES[method].title}
        | {f"largest F, {sweep}": max((_f(r) for r in of_one if r["sweep"] == sweep), default=0.0) for sweep in SWEEPS}
        | {f"F at {DEGREES}°, {sweep}": _f_at_degrees(of_one, sweep) for sweep in ("thresholds", "paper")}
        | {"paper": "curve only, other data"}
        for (benchmark, condition, method), of_one in groups.items()
    ]


def _f(row: Row) -> float:
    both = row["precision"] + row["recall"]
    return 2 * row["precision"] * row["recall"] / both if both else 0.0


def _f_at_degrees(rows: Iterable[Row], sweep: str) -> float:
    return next(_f(row) for row in rows if row["sweep"] == sweep and row["at"] == DEGREES)


def draw_curves(config: Config, rows: list[Row], path: Path) -> None:
    """The three sweeps that are no diagonal by definition."""
    first = [row for row in rows if row["condition"] == rows[0]["condition"]]
    drawn = figures.new(18, 5)
    for axes, sweep in zip(drawn.subplots(1, 3), ("score", "best", "thresholds"), strict=True):
        draw_precision_recall(axes, first, sweep)
    drawn.legend(*drawn.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figures.save(drawn, path)


def plane_errors(rows: list[Row]) -> list[Row]:
    """The three errors of every method, and what the paper prints."""
    lines = [
        {"data": row["benchmark"], "condition": row["condition"], "method": row["title"]}
        | {title: row[name] for name, title in GTE_SDE_COLUMNS.items()}
        | {"answered": f"{row['answered']} of {row['objects']}"}
        for row in rows
    ]
    for method, (gte, sde) in published.GTE_SDE.items():
        about = {"data": published.SHAPENET_DATA, "condition": "clean", "method": f"{method}, printed"}
        lines.append(about | dict(zip(GTE_SDE_COLUMNS.values(), (gte, "", sde), strict=True)) | {"answered": ""})
    return lines


_study = partial(Study, run=lines_of_methods, place=plan.place, data=BENCHMARKS)
_outliers = Sweep(published.OUTLIERS, corruption="outliers")
_missing = Sweep(published.MISSING, corruption="missing")
_partial_scans = Sweep(published.PARTIAL, published.PARTIAL_DATA)

OUTLIERS = _study(
    name="outliers",
    doc="""Which share is right as outliers are added, 0 to 120 % of the points, for all methods.

Outliers are uniform in the bounding box of the posed cloud; how the paper distributes them is not printed. Its numbers
are F on Funk 2017, those here on the data that the table names. It goes on from the results of `arena`.
""",
    sizes=plan.sizes(plan.OUTLIERS, "clean,out100"),
    summary=_outliers.summary,
    draw=_outliers.draw,
    paper="its table of outliers",
)

MISSING = _study(
    name="missing",
    doc="""Which share is right as a part of the points is cut away, 0 to 40 %, for all methods.

The part is the points nearest to a random one. The paper's numbers are F on Funk 2017, those here on the data that the
table names. It goes on from the results of `arena`.
""",
    sizes=plan.sizes(plan.MISSING, "clean,miss28"),
    summary=_missing.summary,
    draw=_missing.draw,
    paper="its table of missing parts",
)

PARTIAL_SCANS = _study(
    name="partial_scans",
    doc="""Which share is right on scans from one side, for ours and the baselines that the paper has on such data.

The paper's numbers are F on twenty real partial scans of other objects; here a scanner at a random viewpoint sees a
generated object, or a real model, from one side. It goes on from the results of `arena`.
""",
    sizes=plan.sizes("view", "view", methods="robust,sym-hks-printed,sym-hks,nagar-raman,hruda,3dsymm"),
    summary=_partial_scans.summary,
    paper="its table of partial scans",
)

PRECISION_RECALL = _study(
    name="precision_recall",
    doc="""Precision against recall of all methods: as a threshold on their scores falls, and as Funk's thresholds rise.

The paper's figure is on Funk 2017 and prints no numbers. It puts all centres at the mean of the cloud and scores one
answer against one truth a shape, so that its curve is a diagonal by definition: the last sweep here. The table has the
largest F of each sweep, and the F at 5°. It goes on from the results of `arena`.
""",
    sizes=plan.sizes("clean", "clean"),
    run=points_of_curves,
    summary=largest_f,
    draw=draw_curves,
    paper="its figure of precision against recall",
)

GTE_SDE = _study(
    name="gte_sde",
    doc="""Ground-truth error and symmetry distance error of the best planes of all methods, on whole objects.

The paper's numbers are of the 1 000 ShapeNet models of PRS-Net; its GTE fits the squared form alone. Here offsets are
about the mean in diagonals, and SDE is of points against a dense sample of the object, in squared diagonals. With
`--benchmark shapenet --data FOLDER` the same runs on those models. It goes on from the results of `arena`.
""",
    sizes=plan.sizes("clean", "clean"),
    summary=plane_errors,
    paper="its table of GTE and SDE",
)
