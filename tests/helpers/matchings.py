"""Random costs of pairs, and independent optima to compare matchings with."""

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp

from symjax.symhks.assignment import SIGN_PENALTY


def random_cost(seed, num_points, prohibited=0.2):
    """Returns symmetric random costs in (0, 1). A fraction of them, and the diagonal, have the penalty added."""
    rng = np.random.default_rng(seed)
    upper = np.triu(rng.random((num_points, num_points)), 1)
    upper += np.triu(np.where(rng.random(upper.shape) < prohibited, SIGN_PENALTY, 0.0), 1)
    return upper + upper.T + SIGN_PENALTY * np.eye(num_points)


def total(cost, pairs):
    return cost[pairs[:, 0], pairs[:, 1]].sum()


def paper_program(cost, q, symmetric=False):
    """Solves the paper's integer program as printed, as a minimisation with one binary variable per p_ij."""
    a = len(cost)
    rows = np.kron(np.eye(a), np.ones((1, a)))
    columns = np.kron(np.ones((1, a)), np.eye(a))
    constraints = [
        LinearConstraint(rows, -np.inf, 1),
        LinearConstraint(columns, -np.inf, 1),
        LinearConstraint(np.ones((1, a * a)), 2 * q, 2 * q),
    ]
    if symmetric:
        transpose = np.eye(a * a)[np.arange(a * a).reshape(a, a).T.ravel()]
        constraints.append(LinearConstraint(np.eye(a * a) - transpose, 0, 0))
    result = milp(cost.ravel(), constraints=constraints, bounds=Bounds(0, 1), integrality=1, options={"mip_rel_gap": 0})
    assert result.status == 0
    return result.fun


def matchings(points, q):
    """Yields every set of q disjoint pairs of the points."""
    if q == 0:
        yield []
    elif len(points) >= 2 * q:
        first, rest = points[0], points[1:]
        yield from matchings(rest, q)
        for k, other in enumerate(rest):
            for others in matchings(rest[:k] + rest[k + 1 :], q - 1):
                yield [(first, other), *others]


def assert_pairs(pairs, cost, num_points):
    """Checks what holds for every matching: i < j, no point twice, cheapest first, no prohibited pair."""
    assert pairs.shape[1:] == (2,)
    assert np.issubdtype(pairs.dtype, np.integer)
    assert (pairs[:, 0] < pairs[:, 1]).all()
    assert len(np.unique(pairs)) == pairs.size
    assert pairs.size == 0 or 0 <= pairs.min() <= pairs.max() < num_points
    costs = cost[pairs[:, 0], pairs[:, 1]]
    assert (np.diff(costs) >= 0).all()
    assert (costs < SIGN_PENALTY).all()
