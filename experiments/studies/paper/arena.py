"""All methods on the same corrupted clouds: hit rate, F, medians, GTE, SDE and seconds by method and condition.

Every task (method, object, condition, seed) is independent of all others: they run through the runner into one file
of results, `arena.jsonl`, which a killed run, a larger one, and the studies of single figures all go on from; `--dask`
sends them to a cluster. The best plane of a method counts whether the method takes it for a symmetry or not; F of Funk
and its curve are of the planes that it holds. An answer is right within 5° and 2 % of the diagonal of the nearest
truth; no answer counts as 90°. SDE is that of points, against 30 000 others of the whole object, so that it scatters
about 0 for an exact plane. "symjax" is the default of `symjax.detect`; where it is not first, the sentences under the
table say so. A baseline that lists where each of its starts ended holds the best alone, one with a rule of its own all
that this accepts. The likelihood's rows and RANSAC on matches have the matches of "our choices". The radius and the
threshold of RANSAC were chosen on objects of these kinds. symjax and Algorithm 1 query their trees on all cores, the
baselines on one; `growth` has the times. What the paper prints is of other data.
"""

from pathlib import Path

from experiments.comparison import published
from experiments.comparison.curves import draw_precision_recall, draw_sweep, precision_recall
from experiments.comparison.leaderboard import MEASURES, OTHERS, leaderboard, pivot
from experiments.comparison.plan import ALL, SMALL, Config, outcomes, place, sizes
from experiments.comparison.shortcomings import shortcomings
from experiments.data import BENCHMARKS
from experiments.framework import figures
from experiments.framework.study import Study
from experiments.framework.tables import Row, markdown

SIZES = sizes(ALL, SMALL.conditions)


def run(config: Config) -> list[Row]:
    """A line a benchmark, condition and method."""
    return leaderboard(outcomes(config))


def summary(rows: list[Row]) -> list[Row]:
    """Methods by conditions, a block a measure, and what the paper prints."""
    names = list(dict.fromkeys(row["condition"] for row in rows))
    printed = published.lines(published.both(), names)
    partial = published.lines(published.PARTIAL, names, published.PARTIAL_DATA)
    return pivot(rows, MEASURES) + printed + partial


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Both curves of precision and recall, F against outliers and against missing parts."""
    first = [row for row in outcomes(config) if row["condition"] == rows[0]["condition"]]
    lines = precision_recall(first)
    drawn = figures.new(13, 9)
    (one, two), (three, four) = drawn.subplots(2, 2)
    draw_precision_recall(one, lines, "score")
    draw_precision_recall(two, lines, "thresholds")
    draw_sweep(three, rows, "outliers", published.OUTLIERS, "F paper")
    draw_sweep(four, rows, "missing", published.MISSING, "F paper")
    drawn.legend(*three.get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figures.save(drawn, path)


def others(rows: list[Row]) -> list[Row]:
    """The further columns, under the first condition."""
    return [
        {"data": row["benchmark"], "condition": row["condition"], "method": row["title"]}
        | {measure.title: row[name] for name, measure in OTHERS.items()}
        for row in rows
        if row["condition"] == rows[0]["condition"]
    ]


def notes(rows: list[Row]) -> str:
    """The further columns, and what has to be said of it all."""
    data = ", ".join(dict.fromkeys(f"{row['benchmark']} ({row['objects']} objects)" for row in rows))
    listed = "\n".join(f"- {sentence}" for sentence in shortcomings(rows))
    note = f"Run on {data}; {rows[0]['points']} points before corruption. What the paper prints is of other data."
    return "\n\n".join([markdown(others(rows)), note, listed])


STUDY = Study(
    "arena", __doc__, SIZES, run, summary, draw=draw, notes=notes, place=place, data=BENCHMARKS, paper="its comparisons"
)
