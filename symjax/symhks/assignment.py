"""Putative mirror pairs of keypoints: the paper's cost and its assignment problem.

The paper maximises Σ p_ij a_ij over binary P with 1ᵀP ≤ 1ᵀ, P1 ≤ 1 and 1ᵀP1 = 2q. Since a_ij is a distance, the
sum is minimised here. Without P = Pᵀ this is a k-cardinality assignment. Its linear relaxation is integral, so that
a linear assignment on a padded matrix solves it exactly. The constraint P = Pᵀ, since a reflection is an involution,
makes it a matching of q edges in a general graph. Its relaxation is not integral: an integer program solves it, for
small sets of keypoints.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, Real
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching
from scipy.spatial.distance import cdist

from symjax.errors import InvalidArgumentError, MatchingError
from symjax.geometry.checks import whole
from symjax.symhks.symmetric_matching import least_matching

SIGN_PENALTY = 1000.0
"""Cost b of pairing two points with equal sign vectors (the paper's value)."""

MAX_SYMMETRIC_POINTS = 300
"""Limit on the keypoints of the symmetric program, whose size grows with their square. At this limit it takes about a
second, and up to ten if many costs are equal."""


def sign_penalty_cost(
    signatures: Float[np.ndarray, "a p"], signs: Real[np.ndarray, "a s"], *, penalty: float = SIGN_PENALTY
) -> Float[np.ndarray, "a a"]:
    """Computes the paper's cost a_ij = ‖h_i − h_j‖₂ + ψ(‖s_i − s_j‖₂), with ψ(0) = b and ψ(t) = 0 for t > 0.

    Two points with equal signs are probably neighbours, not mirror images of each other. The same formula gives b on
    the diagonal: a point is not its own mirror image.

    Args:
        signatures: heat kernel signatures h_i of the keypoints.
        signs: signs s_i of the low eigenfunctions at the keypoints, ±1.
        penalty: b; it must exceed every distance between signatures.

    Returns:
        The symmetric matrix of costs.

    Raises:
        InvalidArgumentError: if the shapes do not match, a signature is not finite, a sign is not ±1, or a distance
            between signatures reaches the penalty.
    """
    h, s = np.asarray(signatures, float), np.asarray(signs, float)
    if h.ndim != 2 or s.ndim != 2 or len(h) != len(s) or 0 in h.shape + s.shape:
        raise InvalidArgumentError(
            "signatures (a, p) and signs (a, s) must have the same a >= 1 rows and at least one column; "
            f"got {h.shape} and {s.shape}"
        )
    _refuse(~np.isfinite(h), "signatures", "not finite")
    _refuse(np.abs(s) != 1.0, "signs", "not +1 or -1 (take -1 where the eigenfunction is negative, else +1)")
    distance = cdist(h, h)
    if not distance.max() < penalty:
        raise InvalidArgumentError(
            f"signatures differ by up to {distance.max():.3g}, and the penalty {penalty:g} must exceed that: "
            "scale the cloud to unit area or raise the penalty"
        )
    # sums of ±1 are exact: s_i · s_j equals the number of signs only for equal sign vectors
    cost: Float[np.ndarray, "a a"] = distance + penalty * (s @ s.T == s.shape[1])
    return cost


def assign_pairs(
    cost: Float[np.ndarray, "a a"], num_pairs: int, *, symmetric: bool = False, penalty: float = SIGN_PENALTY
) -> Int[np.ndarray, "q 2"]:
    """Finds disjoint pairs (i, j), i < j, of least total cost.

    By default, the paper's program is solved exactly for 2q directed matches i → j. Only mutual matches are kept,
    those with j → i as well. That gives at most q pairs: fewer, possibly none, if points are matched in a cycle or
    costs are equal. With `symmetric`, the constraint P = Pᵀ is imposed, which gives exactly q pairs, of least total
    cost among all sets of q disjoint pairs.

    The diagonal and all costs at or above `penalty` are prohibited, not just expensive: such a match is wrong by
    construction, and would be noise if it were added to make up the number. Whenever 2q matches exist without them,
    the result equals that of the paper's finite b, provided that b exceeds the total cost of the 2q matches.

    Args:
        cost: symmetric costs a_ij. Set an entry and its transpose to infinity to prohibit a pair.
        num_pairs: q, the number of pairs.
        symmetric: solve the symmetric program exactly, for at most `MAX_SYMMETRIC_POINTS` points.
        penalty: costs at or above it are prohibited.

    Returns:
        The pairs, in order of their cost.

    Raises:
        InvalidArgumentError: if `cost` is not square or not symmetric, or contains NaN or −infinity; `num_pairs` < 1;
            `penalty` is not positive; or there are too many points for `symmetric`.
        MatchingError: if the allowed entries contain fewer than 2q matches (see `possible_pairs`).
    """
    allowed = _allowed_cost(cost, penalty)
    num_pairs = whole("num_pairs", num_pairs, 1)
    if symmetric:
        check_symmetric(len(allowed))
    possible = _num_matches(allowed) // 2
    if num_pairs > possible:
        raise MatchingError(
            f"{num_pairs} pairs requested, but the allowed costs of {len(allowed)} points permit at most {possible}: "
            "request fewer pairs, use more keypoints, or compare the signs of more eigenfunctions"
        )
    if symmetric:
        pairs = least_matching(allowed, num_pairs)
    else:
        pairs = _mutual(least_assignment(allowed, 2 * num_pairs), len(allowed))
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0], allowed[pairs[:, 0], pairs[:, 1]]))]


def check_symmetric(num_points: int) -> None:
    """Checks that there are not too many points for the symmetric program.

    Raises:
        InvalidArgumentError: if there are more than `MAX_SYMMETRIC_POINTS`.
    """
    if num_points > MAX_SYMMETRIC_POINTS:
        raise InvalidArgumentError(
            f"symmetric=True takes at most {MAX_SYMMETRIC_POINTS} points; got {num_points}: "
            "use fewer keypoints (num_keypoints) or symmetric=False"
        )


def possible_pairs(cost: Float[np.ndarray, "a a"], *, penalty: float = SIGN_PENALTY) -> int:
    """Returns the largest `num_pairs` that `assign_pairs` accepts; only an upper bound if `symmetric`.

    Raises:
        InvalidArgumentError: if the cost or the penalty is invalid, see `assign_pairs`.
    """
    return _num_matches(_allowed_cost(cost, penalty)) // 2


def least_assignment(cost: Float[np.ndarray, "a a"], num_matches: int) -> Int[np.ndarray, "k 2"]:
    """Finds k matches (row, column) of least total cost, with no row and no column used twice.

    The matrix is padded with d = a − k dummy rows and d dummy columns, whose matches with true columns and rows cost
    nothing; matches of two dummies are prohibited. The dummies then occupy d true columns and d true rows, so that
    exactly k true matches remain, and any k true matches can be completed in this way (Dell'Amico and Martello, "The
    k-cardinality assignment problem", 1997). Memory: a matrix of (2a − k)².

    Args:
        cost: costs, without NaN; infinite costs are prohibited. At least k matches must be possible.
        num_matches: k, from 1 to a.

    Returns:
        The matches, in order of their rows.
    """
    num_points = len(cost)
    size = 2 * num_points - num_matches
    padded = np.zeros((size, size))
    padded[:num_points, :num_points] = cost
    padded[num_points:, num_points:] = np.inf
    rows, columns = linear_sum_assignment(padded)
    true = (rows < num_points) & (columns < num_points)
    return np.stack([rows[true], columns[true]], axis=1)


def _mutual(matches: Int[np.ndarray, "k 2"], num_points: int) -> Int[np.ndarray, "q 2"]:
    """Returns the matches i → j, i < j, for which j → i is also a match."""
    partner = np.full(num_points, -1)
    partner[matches[:, 0]] = matches[:, 1]
    i, j = matches.T
    mutual: Int[np.ndarray, "q 2"] = matches[(i < j) & (partner[j] == i)]
    return mutual


def _allowed_cost(cost: Float[np.ndarray, "a a"], penalty: float) -> Float[np.ndarray, "a a"]:
    """Checks the costs and returns a copy, infinite on the diagonal and where a cost reaches the penalty."""
    allowed = np.array(cost, float)
    if allowed.ndim != 2 or allowed.shape[0] != allowed.shape[1] or len(allowed) == 0:
        raise InvalidArgumentError(f"cost must be a square matrix with one row per keypoint; got shape {allowed.shape}")
    if not penalty > 0:
        raise InvalidArgumentError(f"penalty must be positive; got {penalty}")
    _refuse(np.isnan(allowed) | (allowed == -np.inf), "cost", "NaN or -infinity")
    _refuse(~np.isclose(allowed, allowed.T, rtol=1e-9, atol=0.0), "cost", "different from their transpose (j, i)")
    allowed[allowed >= penalty] = np.inf
    np.fill_diagonal(allowed, np.inf)
    return allowed


def _num_matches(cost: Float[np.ndarray, "a a"]) -> int:
    """Returns the largest number of finite entries with no row and no column used twice."""
    return int(np.count_nonzero(maximum_bipartite_matching(csr_array(np.isfinite(cost))) >= 0))


def _refuse(bad: Bool[np.ndarray, "..."], name: str, fault: str) -> None:
    if bad.any():
        first = tuple(int(index) for index in np.argwhere(bad)[0])
        raise InvalidArgumentError(f"{np.count_nonzero(bad)} entries of {name} are {fault}, the first at {first}")
