"""Scores the accepted planes of a method by the measures of SHREC 2023 and of E3Sym."""

from collections.abc import Sequence
from typing import NamedTuple

from experiments.framework.tables import Row
from experiments.metrics import e3sym, shrec
from experiments.metrics.prediction import Prediction


class Measure(NamedTuple):
    """A column of a table.

    Attributes:
        title: title with the unit.
        rises: whether a larger value is better.
        tie: largest difference that counts as a tie.
    """

    title: str
    rises: bool = True
    tie: float = 0.0


TRACKS = {
    "PHC": Measure("PHC: best plane within 1° and 1 %"),
    "mAP": Measure("mAP over hits"),
    "mAP of truths": Measure("mAP over truths"),
    "F E3Sym": Measure("F of E3Sym, mean to 0.2"),
    "F coarse": Measure("F of E3Sym at four thresholds"),
}
"""Columns of the table, by their key in the leaderboard."""


def tracks(predictions: Sequence[Prediction]) -> Row:
    """Computes the measures of `TRACKS` from one method's predictions."""
    phc, of_hits, of_truths = shrec.scores(predictions)
    coarse = e3sym.f_score(predictions, e3sym.COARSE)
    return dict(zip(TRACKS, (phc, of_hits, of_truths, e3sym.f_score(predictions), coarse), strict=True))
