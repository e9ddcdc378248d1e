"""All methods on the same corrupted clouds: hit rate, F, medians, GTE, SDE and seconds by method and condition.

The tasks (method, object, condition, seed) are independent of one another. Their results go into one file,
`arena.jsonl`. A run that was killed, a larger run, and the studies of single tables and figures all continue from this
file; `--dask` runs the tasks on a cluster.

The best plane of a method is scored whether or not the method accepts it as a mirror plane; Funk's F and its curve are
computed from the accepted planes. A plane is correct if it is within 5° and 2 % of the diagonal of the nearest true
plane; no answer counts as 90°. SDE is measured on points, against 30 000 other points of the whole object, so it
scatters about 0 for an exact plane.

"symjax" is the default method of `symjax.detect`; the sentences under the table name the columns in which it is not the
best. A baseline with an acceptance rule of its own accepts all planes that satisfy it; one that only lists the plane
reached from each of its starts accepts the best plane. The MLE baselines and RANSAC on matches use the matches of
"Algorithm 1, our choices". The radius and the threshold of RANSAC were chosen on objects of these kinds. symjax and
Algorithm 1 query their k-d trees on all cores, the baselines on one; the study `growth` compares the run times. The
paper's numbers are for other data.
"""

from pathlib import Path

from experiments.comparison import published
from experiments.comparison.curves import draw_precision_recall, draw_sweep, precision_recall
from experiments.comparison.leaderboard import FURTHER_MEASURES, MEASURES, leaderboard, pivot
from experiments.comparison.plan import ALL, SMALL, Config, outcomes, place, sizes
from experiments.comparison.shortcomings import shortcomings
from experiments.data import BENCHMARKS
from experiments.framework import figures
from experiments.framework.study import Study
from experiments.framework.tables import Row, markdown

SIZES = sizes(ALL, SMALL.conditions)


def run(config: Config) -> list[Row]:
    """Returns one line per benchmark, condition and method."""
    return leaderboard(outcomes(config))


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates methods by conditions, one block per measure, followed by the paper's numbers."""
    names = list(dict.fromkeys(row["condition"] for row in rows))
    whole = published.lines(published.outliers_and_missing(), names)
    partial = published.lines(published.PARTIAL, names, published.PARTIAL_DATA)
    return pivot(rows, MEASURES) + whole + partial


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws two curves of precision and recall, and F against the shares of outliers and of missing points."""
    first = [row for row in outcomes(config) if row["condition"] == rows[0]["condition"]]
    lines = precision_recall(first)
    figure = figures.new(13, 9)
    (over_score, over_thresholds), (over_outliers, over_missing) = figure.subplots(2, 2)
    draw_precision_recall(over_score, lines, "score")
    draw_precision_recall(over_thresholds, lines, "thresholds")
    draw_sweep(over_outliers, rows, "outliers", published.OUTLIERS, "F paper")
    draw_sweep(over_missing, rows, "missing", published.MISSING, "F paper")
    figure.legend(*over_outliers.get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figures.save(figure, path)


def further_measures(rows: list[Row]) -> list[Row]:
    """Tabulates the further measures under the first condition."""
    return [
        {"data": row["benchmark"], "condition": row["condition"], "method": row["title"]}
        | {measure.title: row[name] for name, measure in FURTHER_MEASURES.items()}
        for row in rows
        if row["condition"] == rows[0]["condition"]
    ]


def notes(rows: list[Row]) -> str:
    """Writes the table of the further measures, the data, and the measures in which symjax is not the best."""
    data = ", ".join(dict.fromkeys(f"{row['benchmark']} ({row['objects']} objects)" for row in rows))
    listed = "\n".join(f"- {sentence}" for sentence in shortcomings(rows))
    note = f"Run on {data}; {rows[0]['points']} points before corruption. The paper's numbers are for other data."
    return "\n\n".join([markdown(further_measures(rows)), note, listed])


STUDY = Study(
    "arena", __doc__, SIZES, run, summary, draw=draw, notes=notes, place=place, data=BENCHMARKS, paper="its comparisons"
)
