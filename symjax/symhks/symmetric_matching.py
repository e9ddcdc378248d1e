"""Matching of q edges of least total cost in a general graph, by linear and integer programming.

It solves the paper's program with P = Pᵀ. Points are vertices, pairs are edges, and an infinite cost is a missing edge.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import Bounds, LinearConstraint, OptimizeResult, linprog, milp
from scipy.sparse import csr_array, vstack
from scipy.sparse.csgraph import connected_components

from symjax.errors import MatchingError

COST_RANGE = 1000.0
"""Costs are scaled to [0, COST_RANGE] for the solver, whose tolerances are absolute, near 1e-7."""

TOLERANCE = 1e-6
"""Tolerance on scaled costs and on the solution of the relaxation, larger than the solver's."""

FIRST_EDGES = 8
"""Edges per point in the first integer program. In most cases it is the only one."""

CUT_ROUNDS = 6
"""Limit on the rounds of odd-set cuts. Most relaxations are integral sooner. With many equal costs they may never be,
and the integer program does the rest."""


def least_matching(cost: Float[np.ndarray, "a a"], num_pairs: int) -> Int[np.ndarray, "q 2"]:
    """Finds q disjoint edges (i, j), i < j, of least total cost.

    Let LB be the optimum of the linear relaxation and r_e ≥ 0 the reduced cost of edge e. By linear duality, a matching
    that uses edge e costs at least LB + r_e. The integer program is first solved on the edges of least r_e. Its optimum
    is that of all edges if it is at most LB + r_e for every omitted edge e. Otherwise, the edges with
    r_e < optimum − LB are sufficient.

    Args:
        cost: costs, without NaN, infinite where an edge is prohibited; only the upper triangle is read.
        num_pairs: q, at least 1.

    Returns:
        The edges; their total cost is optimal up to 1e-8 of the range of the finite costs.

    Raises:
        MatchingError: if there are no q disjoint edges, or the solver failed.
    """
    i, j = np.nonzero(np.triu(np.isfinite(cost), 1))
    if not len(i):
        raise _no_matching(num_pairs)
    weight = cost[i, j] - cost[i, j].min()
    if weight.any():
        weight = weight / weight.max() * COST_RANGE
    lower, reduced, rows, limits = _relax(weight, i, j, num_pairs)

    # ties go to the nearest in index, so that a few points do not take all the edges
    order = np.lexsort((j - i, np.round(reduced / TOLERANCE)))
    num_kept = min(FIRST_EDGES * len(cost), len(order))
    while True:
        kept = order[:num_kept]
        chosen = _integer_program(weight[kept], rows[:, kept], limits, num_pairs)
        least_omitted = reduced[order[num_kept]] if num_kept < len(order) else np.inf
        gap = np.inf if chosen is None else weight[kept[chosen]].sum() - lower
        if chosen is not None and gap <= least_omitted + TOLERANCE:
            return np.stack([i[kept[chosen]], j[kept[chosen]]], axis=1)
        if num_kept == len(order):
            raise _no_matching(num_pairs)
        if chosen is None:
            num_kept = min(4 * num_kept, len(order))
        else:
            num_kept = int(np.count_nonzero(reduced < gap))


def _relax(
    weight: Float[np.ndarray, " e"], i: Int[np.ndarray, " e"], j: Int[np.ndarray, " e"], num_pairs: int
) -> tuple[float, Float[np.ndarray, " e"], csr_array, Float[np.ndarray, " r"]]:
    """Solves the linear relaxation; returns its optimum, the reduced costs, and its constraints (rows and limits).

    The first rows require that a point is in at most one edge; the rows of `_odd_cuts` follow.
    """
    edge = np.arange(len(weight))
    ends = np.concatenate([i, j]), np.concatenate([edge, edge])
    rows = csr_array((np.ones(2 * len(edge)), ends), shape=(int(j.max()) + 1, len(edge)))
    limits = np.ones(rows.shape[0])
    relaxed = _linear_program(weight, rows, limits, num_pairs)
    for _ in range(CUT_ROUNDS):
        cuts, most = _odd_cuts(relaxed.x, i, j)
        if not len(most):
            break
        rows, limits = vstack([rows, cuts], format="csr"), np.concatenate([limits, most])
        relaxed = _linear_program(weight, rows, limits, num_pairs)
    reduced = weight - rows.T @ relaxed.ineqlin.marginals - relaxed.eqlin.marginals[0]
    return relaxed.fun, reduced, rows, limits


def _odd_cuts(
    x: Float[np.ndarray, " e"], i: Int[np.ndarray, " e"], j: Int[np.ndarray, " e"]
) -> tuple[csr_array, Float[np.ndarray, " c"]]:
    """Returns the odd-set constraints that x violates, as rows and limits.

    A matching has at most m edges among 2m + 1 points (Edmonds, 1965). Only the connected components of the edges in
    use are checked, since most fractional solutions are odd cycles of edges of 1/2.
    """
    used = np.flatnonzero(x > TOLERANCE)
    num_points = int(j.max()) + 1
    graph = csr_array((np.ones(len(used)), (i[used], j[used])), shape=(num_points, num_points))
    _, component = connected_components(graph, directed=False)
    size = np.bincount(component)
    inside = np.bincount(component[i[used]], weights=x[used], minlength=len(size))
    violated = np.flatnonzero((size % 2 == 1) & (inside > size // 2 + TOLERANCE))
    within = (component[i] == component[j]) & (component[i] == violated[:, None])
    return csr_array(within.astype(float)), (size // 2)[violated].astype(float)


def _linear_program(
    weight: Float[np.ndarray, " e"], rows: csr_array, limits: Float[np.ndarray, " r"], num_pairs: int
) -> OptimizeResult:
    result = linprog(weight, A_ub=rows, b_ub=limits, A_eq=np.ones((1, len(weight))), b_eq=[num_pairs])
    if result.status == 2:
        raise _no_matching(num_pairs)
    if result.status != 0:
        raise MatchingError(f"the relaxation of the symmetric matching was not solved: {result.message}")
    return result


def _integer_program(
    weight: Float[np.ndarray, " e"], rows: csr_array, limits: Float[np.ndarray, " r"], num_pairs: int
) -> Int[np.ndarray, " q"] | None:
    """Finds the q edges of least weight that satisfy the constraints; returns None if there are none."""
    count = LinearConstraint(np.ones((1, len(weight))), num_pairs, num_pairs)
    result = milp(
        weight,
        constraints=[LinearConstraint(rows, ub=limits), count],
        bounds=Bounds(0.0, 1.0),
        integrality=np.ones(len(weight)),
        options={"mip_rel_gap": 0.0},
    )
    if result.status == 2:
        return None
    if result.status != 0:
        raise MatchingError(f"the symmetric matching was not solved: {result.message}")
    return np.flatnonzero(result.x > 0.5)


def _no_matching(num_pairs: int) -> MatchingError:
    return MatchingError(
        f"{num_pairs} pairs requested, but the allowed costs permit fewer disjoint ones: request fewer pairs"
    )
