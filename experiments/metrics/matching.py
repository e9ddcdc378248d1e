"""One-to-one matching of answers to truths, greedily, and counts of the matches, pooled over a data set."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int


def by_rank(cost: Float[np.ndarray, "k t"]) -> Int[np.ndarray, " k"]:
    """Every answer in turn, best first, takes the free truth of least cost.

    Args:
        cost: of answer k and truth t; infinite where they do not match.

    Returns:
        The truth of each answer, −1 where it has none.
    """
    free = np.array(cost, float)
    truth = np.full(len(cost), -1)
    if cost.shape[1] == 0:
        return truth
    for k in range(len(cost)):
        t = int(free[k].argmin())
        if np.isfinite(free[k, t]):
            truth[k] = t
            free[:, t] = np.inf
    return truth


def by_cost(cost: Float[np.ndarray, "k t"]) -> Float[np.ndarray, " m"]:
    """The cheapest pair first, then the cheapest of what is left, until answers or truths are used up.

    A limit on the cost only cuts this sequence short: one matching serves all limits.

    Returns:
        The costs of the pairs, rising.
    """
    left = np.array(cost, float)
    costs = np.empty(min(cost.shape))
    for m in range(len(costs)):
        k, t = np.unravel_index(left.argmin(), left.shape)
        costs[m] = left[k, t]
        left[k, :] = left[:, t] = np.inf
    return costs


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
