"""Five tables and figures of the paper, from the same tasks as the study `arena`.

The studies differ in their conditions, in the columns of their tables and in their figures. All continue from the
results of the study `arena` in the same folder.
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
        paper: the paper's F by method and condition.
        data: title of the data on which the paper's F was measured.
        corruption: "outliers" or "missing", the abscissa of the figure; empty if there is no figure.
    """

    paper: Mapping[str, Mapping[str, float]]
    data: str = published.DATA
    corruption: str = ""

    def summary(self, rows: list[Row]) -> list[Row]:
        """Tabulates methods by conditions, one block per measure, followed by the paper's numbers."""
        names = list(dict.fromkeys(row["condition"] for row in rows))
        return pivot(rows, MEASURES) + published.lines(self.paper, names, self.data)

    def draw(self, config: Config, rows: list[Row], path: Path) -> None:
        """Draws F by the paper's protocol, and the hit rate, which depends on the offset too."""
        figure = figures.new(13, 5)
        for axes, measure in zip(figure.subplots(1, 2), ("F paper", "hit rate"), strict=True):
            draw_sweep(axes, rows, self.corruption, self.paper if measure == "F paper" else {}, measure)
        figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
        figures.save(figure, path)


def lines_of_methods(config: Config) -> list[Row]:
    """Returns one line per benchmark, condition and method."""
    return leaderboard(outcomes(config))


def points_of_curves(config: Config) -> list[Row]:
    """Returns one line per point of the curves of precision and recall."""
    return [line for rows in grouped(outcomes(config), "condition").values() for line in precision_recall(rows)]


def largest_f(rows: list[Row]) -> list[Row]:
    """Returns one line per benchmark, condition and method: the largest F of each sweep, and F at 5° of Funk's two."""
    groups = grouped(rows, "benchmark", "condition", "method")
    return [
        {"data": benchmark, "condition": condition, "method": ENTRIES[method].title}
        | {f"largest F, {sweep}": max((_f(r) for r in group if r["sweep"] == sweep), default=0.0) for sweep in SWEEPS}
        | {f"F at {DEGREES}°, {sweep}": _f_at_degrees(group, sweep) for sweep in ("thresholds", "paper")}
        | {"paper": "curve only, other data"}
        for (benchmark, condition, method), group in groups.items()
    ]


def _f(row: Row) -> float:
    total = row["precision"] + row["recall"]
    return 2 * row["precision"] * row["recall"] / total if total else 0.0


def _f_at_degrees(rows: Iterable[Row], sweep: str) -> float:
    return next(_f(row) for row in rows if row["sweep"] == sweep and row["at"] == DEGREES)


def draw_curves(config: Config, rows: list[Row], path: Path) -> None:
    """Draws the three sweeps whose curve is not the diagonal by definition."""
    first = [row for row in rows if row["condition"] == rows[0]["condition"]]
    figure = figures.new(18, 5)
    for axes, sweep in zip(figure.subplots(1, 3), ("score", "best", "thresholds"), strict=True):
        draw_precision_recall(axes, first, sweep)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figures.save(figure, path)


def plane_errors(rows: list[Row]) -> list[Row]:
    """Tabulates the two forms of GTE and SDE of each method, followed by the paper's numbers."""
    lines = [
        {"data": row["benchmark"], "condition": row["condition"], "method": row["title"]}
        | {title: row[name] for name, title in GTE_SDE_COLUMNS.items()}
        | {"answered": f"{row['answered']} of {row['objects']}"}
        for row in rows
    ]
    for method, (gte, sde) in published.GTE_SDE.items():
        about = {"data": published.SHAPENET_DATA, "condition": "clean", "method": f"{method}, published"}
        lines.append(about | dict(zip(GTE_SDE_COLUMNS.values(), (gte, "", sde), strict=True)) | {"answered": ""})
    return lines


_study = partial(Study, run=lines_of_methods, place=plan.place, data=BENCHMARKS)
_outliers = Sweep(published.OUTLIERS, corruption="outliers")
_missing = Sweep(published.MISSING, corruption="missing")
_partial_scans = Sweep(published.PARTIAL, published.PARTIAL_DATA)

OUTLIERS = _study(
    name="outliers",
    doc="""Hit rate and F of all methods as outliers are added, 0 to 120 % of the points.

The outliers are uniform in the bounding box of the posed cloud; the paper does not state the distribution of its
outliers. The paper's numbers are F on Funk 2017, ours are on the data named in the table. The study continues from the
results of `arena`.
""",
    sizes=plan.sizes(plan.OUTLIERS, "clean,out100"),
    summary=_outliers.summary,
    draw=_outliers.draw,
    paper="its table of outliers",
)

MISSING = _study(
    name="missing",
    doc="""Hit rate and F of all methods as a part of the object is removed, 0 to 40 % of the points.

The part consists of the points nearest to a random point. The paper's numbers are F on Funk 2017, ours are on the data
named in the table. The study continues from the results of `arena`.
""",
    sizes=plan.sizes(plan.MISSING, "clean,miss28"),
    summary=_missing.summary,
    draw=_missing.draw,
    paper="its table of missing parts",
)

PARTIAL_SCANS = _study(
    name="partial_scans",
    doc="""Hit rate and F on scans from one side, for symjax and the baselines that the paper runs on such data.

The paper's numbers are F on twenty real partial scans of other objects. Here a scanner at a random viewpoint sees a
generated object, or a real model, from one side. The study continues from the results of `arena`.
""",
    sizes=plan.sizes("view", "view", methods="robust,sym-hks-printed,sym-hks,nagar-raman,hruda,3dsymm"),
    summary=_partial_scans.summary,
    paper="its table of partial scans",
)

PRECISION_RECALL = _study(
    name="precision_recall",
    doc="""Precision against recall of all methods, as a threshold on their scores falls and as Funk's thresholds rise.

The paper's figure is on Funk 2017, without numbers. The paper puts all centres at the mean of the cloud and scores one
detected plane against one true plane per shape, so its curve is the diagonal by definition; this is the sweep "paper"
here. The table has the largest F of each sweep, and F at 5°. The study continues from the results of `arena`.
""",
    sizes=plan.sizes("clean", "clean"),
    run=points_of_curves,
    summary=largest_f,
    draw=draw_curves,
    paper="its figure of precision against recall",
)

GTE_SDE = _study(
    name="gte_sde",
    doc="""Ground-truth error and symmetry distance error of the best plane of each method, on whole objects.

The paper's numbers are for the 1 000 ShapeNet models of PRS-Net; its GTE is consistent with the squared form only. Here
offsets are measured from the mean of the cloud, in diagonals, and SDE is measured on points, against a dense sample of
the object, in squared diagonals. With `--benchmark shapenet --data FOLDER` the study runs on the ShapeNet models. It
continues from the results of `arena`.
""",
    sizes=plan.sizes("clean", "clean"),
    summary=plane_errors,
    paper="its table of GTE and SDE",
)
