"""Greedy one-to-one matching of predicted planes (answers) to true planes (truths), and counts of the matches."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int


def by_rank(cost: Float[np.ndarray, "k t"]) -> Int[np.ndarray, " k"]:
    """Matches answers to truths in order of rank: each answer takes the free truth of least cost.

    Args:
        cost: cost of each answer, best first, and truth; infinite if they do not match.

    Returns:
        The truth of each answer; −1 if it has none.
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
    """Matches answers to truths in order of cost: the cheapest pair first, until either side is used up.

    A limit on the cost only cuts this sequence short, so one matching serves all limits.

    Args:
        cost: cost of each answer and truth.

    Returns:
        The costs of the matched pairs, ascending.
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
        hits: answers that match a truth (true positives).
        answers: predicted planes.
        truths: true planes.
    """

    hits: int
    answers: int
    truths: int

    @property
    def precision(self) -> float:
        """Hits over answers; 0 if there are no answers."""
        return self.hits / max(self.answers, 1)

    @property
    def recall(self) -> float:
        """Hits over truths; 0 if there are no truths."""
        return self.hits / max(self.truths, 1)

    @property
    def f(self) -> float:
        """Harmonic mean of precision and recall: 2 · hits / (answers + truths)."""
        return 2 * self.hits / max(self.answers + self.truths, 1)


def pooled(tallies: Iterable[Tally]) -> Tally:
    """Sums the counts: a shape with three true planes weighs three times as much as a shape with one."""
    rows = list(tallies)
    return Tally(*(sum(column) for column in zip(*rows, strict=True))) if rows else Tally(0, 0, 0)
