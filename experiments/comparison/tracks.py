"""The planes that a method holds, by the measures of SHREC 2023 and of E3Sym."""

from collections.abc import Sequence
from typing import NamedTuple

from experiments.framework.tables import Row
from experiments.metrics import e3sym, shrec
from experiments.metrics.prediction import Prediction


class Measure(NamedTuple):
    """A column of a table.

    Attributes:
        title: with the unit.
        rises: whether more is better.
        tie: largest difference that says nothing.
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
"""Columns."""


def tracks(all_held: Sequence[Prediction]) -> Row:
    """The measures of one method's answers."""
    phc, of_hits, of_truths = shrec.scores(all_held)
    coarse = e3sym.f_score(all_held, e3sym.COARSE)
    return dict(zip(TRACKS, (phc, of_hits, of_truths, e3sym.f_score(all_held), coarse), strict=True))
