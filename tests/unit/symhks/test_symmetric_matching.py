"""The symmetric matching, compared with all matchings, the paper's program, and a program on all edges."""

import numpy as np
import pytest
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.spatial.distance import cdist

from symjax.errors import InvalidArgumentError, MatchingError
from symjax.symhks.assignment import (
    MAX_SYMMETRIC_POINTS,
    SIGN_PENALTY,
    assign_pairs,
    least_assignment,
    possible_pairs,
)
from tests.helpers.matchings import assert_pairs, matchings, paper_program, random_cost, total


class TestSymmetric:
    @pytest.mark.parametrize("seed", range(6))
    @pytest.mark.parametrize(("num_points", "q"), [(4, 2), (6, 2), (7, 3), (8, 1), (8, 3), (8, 4)])
    def test_is_the_best_of_all_matchings(self, seed, num_points, q):
        cost = random_cost(seed, num_points, prohibited=0.15)
        costs = [sum(cost[pair] for pair in pairs) for pairs in matchings(list(range(num_points)), q)]
        if min(costs) >= SIGN_PENALTY:
            with pytest.raises(MatchingError):
                assign_pairs(cost, q, symmetric=True)
            return
        pairs = assign_pairs(cost, q, symmetric=True)
        assert_pairs(pairs, cost, num_points)
        assert len(pairs) == q
        assert total(cost, pairs) == pytest.approx(min(costs), abs=1e-8)

    @pytest.mark.parametrize("seed", range(3))
    def test_reaches_the_optimum_of_the_papers_program_with_symmetry(self, seed):
        cost = random_cost(seed, 14)
        pairs = assign_pairs(cost, 5, symmetric=True)
        assert 2 * total(cost, pairs) == pytest.approx(paper_program(cost, 5, symmetric=True), abs=1e-8)

    @pytest.mark.parametrize("seed", range(3))
    def test_many_points_against_a_program_on_every_edge(self, seed):
        """There are so many points that the first program omits edges, and odd cycles make the relaxation fractional.

        The oracle has all edges and no cuts.
        """
        points = np.random.default_rng(seed).normal(size=(41, 3))
        cost, q = cdist(points, points), 20
        i, j = np.triu_indices(41, 1)
        incidence = np.zeros((41, len(i)))
        incidence[i, np.arange(len(i))] = incidence[j, np.arange(len(i))] = 1
        constraints = [LinearConstraint(incidence, ub=np.ones(41)), LinearConstraint(np.ones((1, len(i))), q, q)]
        oracle = milp(
            cost[i, j], constraints=constraints, bounds=Bounds(0, 1), integrality=1, options={"mip_rel_gap": 0}
        )
        pairs = assign_pairs(cost, q, symmetric=True)
        assert total(cost, pairs) == pytest.approx(oracle.fun, abs=1e-6)
        directed = least_assignment(np.where(np.eye(41) > 0, np.inf, cost), 2 * q)
        assert total(cost, directed) < 2 * oracle.fun - 1e-3, "the relaxation is integral: the cuts are not tested"

    def test_costs_at_least_half_the_directed_optimum(self):
        cost = random_cost(3, 40)
        directed = least_assignment(np.where(cost >= SIGN_PENALTY, np.inf, cost), 20)
        pairs = assign_pairs(cost, 10, symmetric=True)
        assert len(pairs) == 10
        assert total(cost, pairs) >= total(cost, directed) / 2 - 1e-8

    def test_clusters_of_three_with_equal_costs(self):
        """Ten triangles with costs of zero: one pair each is free, and every relaxation is fractional."""
        points = np.repeat(np.random.default_rng(0).normal(size=(10, 3)), 3, axis=0)
        cost = cdist(points, points)
        assert total(cost, assign_pairs(cost, 10, symmetric=True)) == pytest.approx(0, abs=1e-7)
        costly = assign_pairs(cost, 11, symmetric=True)
        assert total(cost, costly) == pytest.approx(cost[cost > 0].min(), abs=1e-7)

    def test_equal_costs_everywhere(self):
        pairs = assign_pairs(np.zeros((30, 30)), 15, symmetric=True)
        assert_pairs(pairs, np.zeros((30, 30)), 30)
        assert len(pairs) == 15

    def test_an_odd_cycle_of_allowed_pairs_contains_fewer_than_its_relaxation(self):
        """Two triangles: the relaxation has three pairs, a matching two."""
        cost = np.full((6, 6), np.inf)
        cost[:3, :3] = cost[3:, 3:] = 1.0
        assert possible_pairs(cost) == 3
        assert len(assign_pairs(cost, 2, symmetric=True)) == 2
        with pytest.raises(MatchingError, match="request fewer"):
            assign_pairs(cost, 3, symmetric=True)

    def test_refuses_a_set_too_large(self):
        num_points = MAX_SYMMETRIC_POINTS + 1
        with pytest.raises(InvalidArgumentError, match="use fewer keypoints"):
            assign_pairs(np.zeros((num_points, num_points)), 3, symmetric=True)
