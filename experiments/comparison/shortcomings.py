"""The measures in which symjax's default method is not the best, one sentence each, from the numbers of the table."""

from collections.abc import Mapping, Sequence

from experiments.baselines.registry import ENTRIES, OURS
from experiments.comparison.leaderboard import FURTHER_MEASURES, MEASURES
from experiments.comparison.tracks import Measure
from experiments.framework.tables import Row, grouped

DIGITS = 3
"""Significant digits in the tables: values that agree in them are tied."""


def shortcomings(lines: Sequence[Row], measures: Mapping[str, Measure] = MEASURES | FURTHER_MEASURES) -> list[str]:
    """Returns a sentence for each benchmark, condition and measure in which another method is better than symjax's.

    The first sentence counts the columns in which symjax's default is first or tied.

    Args:
        lines: lines of `leaderboard`.
        measures: the measures to compare, by the name of their column.
    """
    sentences, columns = [], 0
    for (benchmark, condition), group in grouped(lines, "benchmark", "condition").items():
        for name, measure in measures.items():
            behind = _behind(group, name, measure)
            columns += behind is not None
            if behind:
                sentences.append(f"{benchmark}, {condition}, {measure.title}: {behind}")
    if not columns:
        return ["There is nothing to compare: symjax's default is not among the methods, or is the only one."]
    return [f"symjax's default is first or tied in {columns - len(sentences)} of {columns} columns.", *sentences]


def _behind(lines: Sequence[Row], column: str, measure: Measure) -> str | None:
    """A sentence if symjax is behind, empty if it is not, None if there is nothing to compare it with."""
    values = {line["method"]: _rounded(line[column]) for line in lines if line[column] != ""}
    if OURS not in values or len(values) < 2:
        return None
    ours, sign = values[OURS], 1 if measure.rises else -1
    better = {name: value for name, value in values.items() if sign * (value - ours) > measure.tie}
    if not better:
        return ""
    best = max(better, key=lambda name: sign * better[name])
    others = f" and {len(better) - 1} more" if len(better) > 1 else ""
    return f"symjax has {ours:g}, and {ENTRIES[best].title} has {better[best]:g}{others}; it is not first here."


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
