"""Where symjax's default is not first: said in a sentence a column, from the numbers of the table."""

from collections.abc import Mapping, Sequence

from experiments.baselines.registry import ENTRIES, OURS
from experiments.comparison.leaderboard import MEASURES, OTHERS
from experiments.comparison.tracks import Measure
from experiments.framework.tables import Row, grouped

DIGITS = 3
"""Significant ones that tables show: what is the same in them is a tie."""


def shortcomings(lines: Sequence[Row], measures: Mapping[str, Measure] = MEASURES | OTHERS) -> list[str]:
    """One for every benchmark, condition and measure in which another method is better, and one that counts the rest.

    Args:
        lines: of `leaderboard`.
        measures: by the name of the column.
    """
    said, columns = [], 0
    for (benchmark, condition), of_both in grouped(lines, "benchmark", "condition").items():
        for name, measure in measures.items():
            behind = _behind(of_both, name, measure)
            columns += behind is not None
            if behind:
                said.append(f"{benchmark}, {condition}, {measure.title}: {behind}")
    if not columns:
        return ["symjax's default is not among the methods, or is alone: nothing to compare."]
    return [f"symjax's default is first or tied in {columns - len(said)} of {columns} columns.", *said]


def _behind(lines: Sequence[Row], column: str, measure: Measure) -> str | None:
    """A sentence where ours is behind, empty where it is not, None where there is nothing to compare it with."""
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
