"""The matching of q edges of least cost in a general graph: the paper's program with P = Pᵀ, by linear and integer
programming. Points are vertices, pairs edges, infinite costs are edges that are not there.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import Bounds, LinearConstraint, OptimizeResult, linprog, milp
from scipy.sparse import csr_array, vstack
from scipy.sparse.csgraph import connected_components

from symjax.errors import MatchingError

COST_RANGE = 1000.0
"""Costs are stretched to [0, COST_RANGE] for the solver, whose tolerances are absolute, near 1e-7."""

TOLERANCE = 1e-6
"""Slack in stretched costs and in the solution of the relaxation, above the solver's tolerance."""

FIRST_EDGES = 8
"""Edges a point in the first integer program, which is mostly the only one."""

CUT_ROUNDS = 6
"""Most rounds of odd-set cuts. Most relaxations are integral sooner; among many equal costs they need not become so,
and the integer program does the rest."""


def least_matching(cost: Float[np.ndarray, "a a"], num_pairs: int) -> Int[np.ndarray, "q 2"]:
    """The q edges (i, j), i < j, of least total cost with no point in two of them.

    Linear duality bounds any matching that uses edge e from below by LB + r_e, with LB the optimum of the
    relaxation and r_e ≥ 0 the reduced cost. So the optimum among the edges of least r_e is the optimum of all
    once it is at most LB + r_e of every edge left out; if it is more, the edges with r_e < optimum − LB are enough.

    Args:
        cost: costs of which the upper triangle is read, infinite where an edge is prohibited, without NaN.
        num_pairs: q, at least 1.

    Returns:
        The optimum to 1e-8 of the range of the finite costs.

    Raises:
        MatchingError: there are no q such edges, or the solver gave up.
    """
    i, j = np.nonzero(np.triu(np.isfinite(cost), 1))
    if not len(i):
        raise _no_matching(num_pairs)
    weight = cost[i, j] - cost[i, j].min()
    if weight.any():
        weight = weight / weight.max() * COST_RANGE
    lower, reduced, rows, limits = _relax(weight, i, j, num_pairs)

    # Among equals the nearest in index first: no few points take all the places.
    order = np.lexsort((j - i, np.round(reduced / TOLERANCE)))
    num_kept = min(FIRST_EDGES * len(cost), len(order))
    while True:
        kept = order[:num_kept]
        chosen = _integer_program(weight[kept], rows[:, kept], limits, num_pairs)
        left_out = reduced[order[num_kept]] if num_kept < len(order) else np.inf
        gap = np.inf if chosen is None else weight[kept[chosen]].sum() - lower
        if chosen is not None and gap <= left_out + TOLERANCE:
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
    """Linear relaxation: its optimum, the edges' reduced costs, and its rows and their limits.

    The rows say that a point is in one edge at most, and those of `_odd_cuts` follow.
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
    """Rows and limits that x breaks: 2m + 1 points hold at most m edges of a matching (Edmonds, 1965).

    Looked for among the connected pieces of the edges in use: a fractional solution mostly has odd rings of 1/2.
    """
    used = np.flatnonzero(x > TOLERANCE)
    num_points = int(j.max()) + 1
    graph = csr_array((np.ones(len(used)), (i[used], j[used])), shape=(num_points, num_points))
    _, piece = connected_components(graph, directed=False)
    size = np.bincount(piece)
    inside = np.bincount(piece[i[used]], weights=x[used], minlength=len(size))
    broken = np.flatnonzero((size % 2 == 1) & (inside > size // 2 + TOLERANCE))
    within = (piece[i] == piece[j]) & (piece[i] == broken[:, None])
    return csr_array(within.astype(float)), (size // 2)[broken].astype(float)


def _linear_program(
    weight: Float[np.ndarray, " e"], rows: csr_array, limits: Float[np.ndarray, " r"], num_pairs: int
) -> OptimizeResult:
    result = linprog(weight, A_ub=rows, b_ub=limits, A_eq=np.ones((1, len(weight))), b_eq=[num_pairs])
    if result.status == 2:
        raise _no_matching(num_pairs)
    if result.status != 0:
        raise MatchingError(f"the relaxed matching was not solved: {result.message}")
    return result


def _integer_program(
    weight: Float[np.ndarray, " e"], rows: csr_array, limits: Float[np.ndarray, " r"], num_pairs: int
) -> Int[np.ndarray, " q"] | None:
    """The q edges of least weight within the limits of the rows; None if there are none such."""
    every = LinearConstraint(np.ones((1, len(weight))), num_pairs, num_pairs)
    result = milp(
        weight,
        constraints=[LinearConstraint(rows, ub=limits), every],
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
        f"{num_pairs} pairs asked for, but the allowed costs hold fewer without a point in two: ask for fewer pairs"
    )
