"""One-to-one matching and pooled counts."""

import numpy as np
import pytest

from experiments.metrics import matching
from experiments.metrics.matching import Tally, pooled


def test_matching_by_rank_lets_the_better_answer_choose_first():
    cost = np.array([[1.0, 2.0], [0.0, 5.0], [0.0, np.inf]])
    assert matching.by_rank(cost).tolist() == [0, 1, -1]
    assert matching.by_rank(np.empty((2, 0))).tolist() == [-1, -1]


def test_matching_by_cost_takes_the_cheapest_pair_first():
    assert matching.by_cost(np.array([[1.0, 2.0], [0.0, 5.0]])).tolist() == [0.0, 2.0]
    assert matching.by_cost(np.empty((0, 3))).size == 0


def test_a_tally_pools_counts_and_not_rates():
    tally = pooled([Tally(1, 1, 1), Tally(1, 4, 3)])
    assert tally == Tally(2, 5, 4)
    assert (tally.precision, tally.recall) == (0.4, 0.5)
    assert tally.f == pytest.approx(2 * 0.4 * 0.5 / 0.9)
    assert pooled([]).f == 0.0
