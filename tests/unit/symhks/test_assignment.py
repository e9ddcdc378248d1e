"""Pairs of keypoints: the padded assignment and the symmetric matching, compared with independent optima."""

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp

from symjax.errors import InvalidArgumentError, MatchingError
from symjax.symhks.assignment import (
    SIGN_PENALTY,
    assign_pairs,
    least_assignment,
    possible_pairs,
    sign_penalty_cost,
)
from tests.helpers.matchings import assert_pairs, paper_program, random_cost, total

SIZES = [(seed, num_points, q) for seed in range(4) for num_points, q in ((6, 1), (9, 3), (12, 4), (12, 6))]


class TestCost:
    def test_is_the_formula_of_the_paper(self, rng):
        h, s = rng.normal(size=(7, 4)), np.where(rng.random((7, 2)) < 0.5, -1, 1)
        cost = sign_penalty_cost(h, s)
        for i in range(7):
            for j in range(7):
                psi = 1000.0 if np.linalg.norm(s[i] - s[j]) == 0 else 0.0
                assert cost[i, j] == pytest.approx(np.linalg.norm(h[i] - h[j]) + psi, abs=1e-12)

    def test_is_symmetric_with_the_penalty_on_the_diagonal(self, rng):
        cost = sign_penalty_cost(rng.normal(size=(9, 5)), np.sign(rng.normal(size=(9, 3))), penalty=50.0)
        np.testing.assert_array_equal(cost, cost.T)
        np.testing.assert_array_equal(np.diag(cost), np.full(9, 50.0))

    def test_integer_signs_do_not_overflow(self):
        signs = np.ones((3, 300), np.int8)
        signs[0, 0] = -1
        cost = sign_penalty_cost(np.zeros((3, 1)), signs)
        np.testing.assert_array_equal(cost, [[1000, 0, 0], [0, 1000, 1000], [0, 1000, 1000]])

    @pytest.mark.parametrize(
        ("signatures", "signs", "message"),
        [
            (np.zeros((3, 2)), np.ones((4, 2)), "same a"),
            (np.zeros(3), np.ones((3, 2)), "same a"),
            (np.zeros((3, 2)), np.ones((3, 0)), "same a"),
            (np.zeros((0, 2)), np.ones((0, 2)), "same a"),
            (np.array([[0.0], [np.nan]]), np.ones((2, 1)), r"1 entries of signatures.*first at \(1, 0\)"),
            (np.zeros((2, 1)), np.array([[1.0], [0.0]]), r"1 entries of signs.*first at \(1, 0\)"),
            (np.array([[0.0], [2000.0]]), np.ones((2, 1)), "must exceed"),
        ],
    )
    def test_refuses_bad_input(self, signatures, signs, message):
        with pytest.raises(InvalidArgumentError, match=message):
            sign_penalty_cost(signatures, signs)


class TestAssignment:
    @pytest.mark.parametrize(("seed", "num_points", "q"), SIZES)
    def test_reaches_the_optimum_of_the_papers_program(self, seed, num_points, q):
        cost = random_cost(seed, num_points, prohibited=0.1)
        prohibited = np.where(cost >= SIGN_PENALTY, np.inf, cost)
        matches = least_assignment(prohibited, 2 * q)
        assert matches.shape == (2 * q, 2)
        assert len(np.unique(matches[:, 0])) == len(np.unique(matches[:, 1])) == 2 * q
        assert total(cost, matches) == pytest.approx(paper_program(cost, q), abs=1e-9)

    @pytest.mark.parametrize("num_matches", range(1, 8))
    def test_any_number_of_matches_of_costs_that_are_not_symmetric(self, num_matches):
        cost = np.random.default_rng(num_matches).normal(size=(7, 7))
        matches = least_assignment(cost, num_matches)
        rows, columns = np.kron(np.eye(7), np.ones((1, 7))), np.kron(np.ones((1, 7)), np.eye(7))
        number = LinearConstraint(np.ones((1, 49)), num_matches, num_matches)
        limits = [LinearConstraint(rows, ub=np.ones(7)), LinearConstraint(columns, ub=np.ones(7)), number]
        oracle = milp(cost.ravel(), constraints=limits, bounds=Bounds(0, 1), integrality=1)
        assert len(matches) == num_matches
        assert total(cost, matches) == pytest.approx(oracle.fun, abs=1e-9)

    @pytest.mark.parametrize(("seed", "num_points", "q"), SIZES)
    def test_keeps_the_mutual_matches_of_the_optimum(self, seed, num_points, q):
        cost = random_cost(seed, num_points, prohibited=0.1)
        pairs = assign_pairs(cost, q)
        assert_pairs(pairs, cost, num_points)
        matches = least_assignment(np.where(cost >= SIGN_PENALTY, np.inf, cost), 2 * q)
        directed = {tuple(match) for match in matches.tolist()}
        mutual = {(i, j) for i, j in directed if i < j and (j, i) in directed}
        assert {tuple(pair) for pair in pairs.tolist()} == mutual

    def test_cycles_of_three_contain_no_mutual_pair(self):
        """Two triangles far apart: six matches go round them, and three pairs need one between the two."""
        cost = np.full((6, 6), 500.0)
        cost[:3, :3] = cost[3:, 3:] = 1.0
        assert assign_pairs(cost, 3).shape == (0, 2)
        pairs = assign_pairs(cost, 3, symmetric=True)
        assert total(cost, pairs) == pytest.approx(502.0, abs=1e-6)


@pytest.mark.parametrize("symmetric", [False, True])
class TestPairs:
    def test_a_planted_involution_is_recovered(self, rng, symmetric):
        """Twins have equal signatures up to noise and differ in a sign; neighbours have equal signatures and signs."""
        num_twins, q = 30, 25
        left = rng.uniform(size=(num_twins, 6))
        signs = np.where(rng.random((num_twins, 3)) < 0.5, -1, 1)
        h = np.concatenate([left, left + 1e-3 * rng.normal(size=left.shape), left + 1e-5])
        s = np.concatenate([np.c_[signs, np.ones(num_twins)], np.c_[signs, -np.ones(num_twins)]])
        s = np.concatenate([s, np.c_[signs, np.ones(num_twins)]])
        # the last third are neighbours of the first, nearer in signature than the twins
        cost = sign_penalty_cost(h, s)
        assert (cost[:num_twins, 2 * num_twins :].diagonal() >= SIGN_PENALTY).all()
        twins = assign_pairs(cost[: 2 * num_twins, : 2 * num_twins], q, symmetric=symmetric)
        assert len(twins) == q
        np.testing.assert_array_equal(twins[:, 1] - twins[:, 0], num_twins)
        among = assign_pairs(cost, q, symmetric=symmetric)
        assert_pairs(among, cost, len(cost))
        assert len(among) >= 20
        np.testing.assert_array_equal((among[:, 1] - among[:, 0]) % num_twins, 0)

    def test_a_permutation_of_the_points_permutes_the_pairs(self, rng, symmetric):
        cost = random_cost(7, 24)
        order = rng.permutation(24)
        pairs = assign_pairs(cost, 6, symmetric=symmetric)
        permuted = order[assign_pairs(cost[np.ix_(order, order)], 6, symmetric=symmetric)]
        np.testing.assert_array_equal(np.sort(permuted, axis=1), pairs)

    @pytest.mark.parametrize("scale", [1e-12, 1e9])
    def test_the_scale_of_the_costs_does_not_matter(self, symmetric, scale):
        cost = random_cost(8, 20, prohibited=0.0)
        expected = assign_pairs(cost, 6, symmetric=symmetric)
        scaled = assign_pairs(scale * cost, 6, symmetric=symmetric, penalty=scale * SIGN_PENALTY)
        np.testing.assert_array_equal(scaled, expected)

    @pytest.mark.parametrize("penalty", [1000.0, 1e15, np.inf])
    def test_prohibited_pairs_are_never_chosen_and_cost_no_precision(self, symmetric, penalty):
        """The cheapest pairs are prohibited, and a huge penalty does not round the small costs."""
        cost = 1e-9 * random_cost(9, 16, prohibited=0.0)
        np.fill_diagonal(cost, 0.0)
        expected = assign_pairs(cost, 4, symmetric=symmetric)
        mask = np.zeros((16, 16), bool)
        mask[tuple(expected.T)] = True
        mask |= mask.T
        pairs = assign_pairs(
            np.where(mask, penalty, cost), 4, symmetric=symmetric, penalty=penalty if penalty < np.inf else 1000.0
        )
        assert len(pairs) > 0
        assert not mask[pairs[:, 0], pairs[:, 1]].any()
        np.testing.assert_array_equal(pairs, assign_pairs(np.where(mask, 1000.0, cost), 4, symmetric=symmetric))

    def test_the_input_is_not_changed(self, symmetric):
        cost = random_cost(1, 10)
        before = cost.copy()
        assign_pairs(cost, 2, symmetric=symmetric)
        np.testing.assert_array_equal(cost, before)

    def test_too_few_possible_pairs(self, symmetric):
        cost = np.full((10, 10), SIGN_PENALTY)
        cost[0, 5] = cost[5, 0] = cost[1, 6] = cost[6, 1] = 0.5
        cost[1, 7] = cost[7, 1] = 0.6
        assert possible_pairs(cost) == 2
        assert len(assign_pairs(cost, 2, symmetric=symmetric)) == 2
        with pytest.raises(MatchingError, match=r"3 pairs requested.*at most 2"):
            assign_pairs(cost, 3, symmetric=symmetric)

    def test_more_pairs_than_points(self, symmetric):
        with pytest.raises(MatchingError, match="at most 2"):
            assign_pairs(np.ones((5, 5)), 3, symmetric=symmetric)

    @pytest.mark.parametrize("num_pairs", [0, -1, 2.0, True, None])
    def test_refuses_an_invalid_number_of_pairs(self, symmetric, num_pairs):
        with pytest.raises(InvalidArgumentError, match="num_pairs"):
            assign_pairs(np.ones((6, 6)), num_pairs, symmetric=symmetric)

    @pytest.mark.parametrize("penalty", [0.0, -1.0, np.nan])
    def test_refuses_a_penalty_that_is_not_positive(self, symmetric, penalty):
        with pytest.raises(InvalidArgumentError, match="penalty must be positive"):
            assign_pairs(np.ones((6, 6)), 1, symmetric=symmetric, penalty=penalty)

    @pytest.mark.parametrize(
        ("bad", "message"),
        [
            (np.ones((4, 5)), "square"),
            (np.ones(4), "square"),
            (np.ones((0, 0)), "square"),
            (np.where(np.eye(4) > 0, np.nan, 1.0), r"4 entries of cost are NaN.*first at \(0, 0\)"),
            (np.where(np.eye(4) > 0, -np.inf, 1.0), r"4 entries of cost are NaN or -infinity"),
            (np.triu(np.ones((4, 4))), r"12 entries of cost are different from.*first at \(0, 1\)"),
        ],
    )
    def test_refuses_bad_costs(self, symmetric, bad, message):
        with pytest.raises(InvalidArgumentError, match=message):
            assign_pairs(bad, 1, symmetric=symmetric)
        with pytest.raises(InvalidArgumentError, match=message):
            possible_pairs(bad)
