"""Assignments against independent solutions of the paper's programs, planted involutions, and bad input."""

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp

from symjax.errors import InvalidArgumentError, MatchingError
from symjax.matching import (
    MAX_SYMMETRIC_POINTS,
    assign_pairs,
    least_assignment,
    possible_pairs,
    sign_penalty_cost,
)


def costs(rng, num_points):
    cost = rng.uniform(size=(num_points, num_points))
    return (cost + cost.T) / 2


def printed_program(cost, num_matches):
    """Least Σ p_ij a_ij with 1ᵀP ≤ 1, P1 ≤ 1, 1ᵀP1 = 2q and no point its own mirror: the paper's, word for word."""
    a = len(cost)
    row = np.kron(np.eye(a), np.ones((1, a)))
    column = np.kron(np.ones((1, a)), np.eye(a))
    diagonal = np.eye(a).reshape(-1)
    result = milp(
        cost.reshape(-1),
        constraints=[
            LinearConstraint(row, ub=1),
            LinearConstraint(column, ub=1),
            LinearConstraint(np.ones((1, a * a)), lb=num_matches, ub=num_matches),
        ],
        integrality=1,
        bounds=Bounds(0, 1 - diagonal),
    )
    return result.fun


def matchings(points, num_pairs):
    """All sets of pairs of distinct points."""
    if num_pairs == 0:
        yield []
        return
    for k, first in enumerate(points):
        rest = points[k + 1 :]
        for second in rest:
            remaining = [p for p in rest if p != second]
            for others in matchings(remaining, num_pairs - 1):
                yield [(first, second), *others]


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("num_pairs", [1, 2, 4])
def test_the_assignment_is_the_optimum_of_the_printed_program(seed, num_pairs):
    cost = costs(np.random.default_rng(seed), 9)
    forbidden = cost.copy()
    np.fill_diagonal(forbidden, np.inf)
    matches = least_assignment(forbidden, 2 * num_pairs)
    assert len(matches) == 2 * num_pairs
    assert len(set(matches[:, 0])) == len(set(matches[:, 1])) == 2 * num_pairs
    assert cost[tuple(matches.T)].sum() == pytest.approx(printed_program(cost, 2 * num_pairs), abs=1e-9)
    chosen = {tuple(match) for match in matches.tolist()}
    mutual = {(i, j) for i, j in chosen if i < j and (j, i) in chosen}
    assert {tuple(pair) for pair in assign_pairs(cost, num_pairs).tolist()} == mutual


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("num_pairs", [1, 2, 3])
def test_the_symmetric_matching_is_the_best_of_all(seed, num_pairs):
    cost = costs(np.random.default_rng(seed), 7)
    pairs = assign_pairs(cost, num_pairs, symmetric=True)
    assert len(pairs) == num_pairs
    assert len(set(pairs.reshape(-1))) == 2 * num_pairs
    best = min(sum(cost[i, j] for i, j in each) for each in matchings(list(range(7)), num_pairs))
    assert cost[tuple(pairs.T)].sum() == pytest.approx(best, abs=1e-9)


@pytest.mark.parametrize("symmetric", [False, True])
def test_a_planted_involution_is_recovered(rng, symmetric):
    descriptors = rng.normal(size=(30, 4))
    cost = np.linalg.norm(np.tile(descriptors, (2, 1))[:, None] - np.tile(descriptors, (2, 1))[None], axis=2)
    pairs = assign_pairs(cost, 30, symmetric=symmetric)
    np.testing.assert_array_equal(pairs[np.argsort(pairs[:, 0])], np.stack([np.arange(30), np.arange(30, 60)], axis=1))


@pytest.mark.parametrize("symmetric", [False, True])
def test_pairs_move_with_the_points(rng, symmetric):
    cost, order = costs(rng, 24), rng.permutation(24)
    pairs = assign_pairs(cost, 6, symmetric=symmetric)
    moved = order[assign_pairs(cost[np.ix_(order, order)], 6, symmetric=symmetric)]
    assert {frozenset(pair) for pair in moved.tolist()} == {frozenset(pair) for pair in pairs.tolist()}


@pytest.mark.parametrize("symmetric", [False, True])
def test_pairs_come_cheapest_first_and_never_pay_the_penalty(rng, symmetric):
    cost = costs(rng, 20)
    blocked = rng.uniform(size=cost.shape) < 0.2
    blocked |= blocked.T
    cost[blocked] += 1000.0
    pairs = assign_pairs(cost, 7, symmetric=symmetric)
    paid = cost[tuple(pairs.T)]
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert (np.diff(paid) >= 0).all()
    assert (paid < 1000.0).all()


def test_the_penalty_falls_on_equal_signs_alone(rng):
    signatures, signs = rng.normal(size=(6, 3)), np.ones((6, 2))
    signs[3:, 1] = -1
    cost = sign_penalty_cost(signatures, signs)
    distance = np.linalg.norm(signatures[:, None] - signatures[None], axis=2)
    expected = distance + 1000.0 * (np.arange(6)[:, None] // 3 == np.arange(6)[None] // 3)
    np.testing.assert_allclose(cost, expected, atol=1e-12)


def test_what_cannot_be_matched_is_refused_with_the_number_that_can():
    cost = np.full((6, 6), 2000.0)
    cost[0, 1] = cost[1, 0] = 1.0
    assert possible_pairs(cost) == 1
    np.testing.assert_array_equal(assign_pairs(cost, 1), [[0, 1]])
    with pytest.raises(MatchingError, match="at most 1"):
        assign_pairs(cost, 2)


@pytest.mark.parametrize(
    ("cost", "num_pairs", "options"),
    [
        (np.zeros((3, 4)), 1, {}),
        (np.zeros(9), 1, {}),
        (np.full((4, 4), np.nan), 1, {}),
        (np.arange(16.0).reshape(4, 4), 1, {}),
        (np.zeros((4, 4)), 0, {}),
        (np.zeros((4, 4)), 1.5, {}),
        (np.zeros((MAX_SYMMETRIC_POINTS + 1,) * 2), 1, {"symmetric": True}),
    ],
)
def test_bad_costs_and_numbers_are_refused(cost, num_pairs, options):
    with pytest.raises(InvalidArgumentError):
        assign_pairs(cost, num_pairs, **options)


@pytest.mark.parametrize(
    ("signatures", "signs"),
    [
        (np.zeros((3, 2)), np.ones((4, 2))),
        (np.full((3, 2), np.nan), np.ones((3, 2))),
        (np.zeros((3, 2)), np.zeros((3, 2))),
        (np.arange(6.0).reshape(3, 2) * 1e4, np.ones((3, 2))),
    ],
)
def test_bad_signatures_and_signs_are_refused(signatures, signs):
    with pytest.raises(InvalidArgumentError):
        sign_penalty_cost(signatures, signs)
