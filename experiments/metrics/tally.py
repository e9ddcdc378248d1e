"""Precision, recall and F from counts, pooled over a data set."""

from collections.abc import Iterable
from typing import NamedTuple


class Tally(NamedTuple):
    """Counts over a data set.

    Attributes:
        hits: answers that were matched to a truth (true positives).
        answers: planes that were proposed.
        truths: planes that are right.
    """

    hits: int
    answers: int
    truths: int

    @property
    def precision(self) -> float:
        """Hits over answers; 0 where nothing was proposed."""
        return self.hits / max(self.answers, 1)

    @property
    def recall(self) -> float:
        """Hits over truths; 0 where there are none."""
        return self.hits / max(self.truths, 1)

    @property
    def f(self) -> float:
        """Harmonic mean of precision and recall: 2 · hits / (answers + truths)."""
        return 2 * self.hits / max(self.answers + self.truths, 1)


def pooled(tallies: Iterable[Tally]) -> Tally:
    """The sums of all counts: a shape with three planes weighs three times as much as one with a single plane."""
    rows = list(tallies)
    return Tally(*(sum(column) for column in zip(*rows, strict=True))) if rows else Tally(0, 0, 0)
