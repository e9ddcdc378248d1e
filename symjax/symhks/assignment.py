"""Pairs of keypoints that may be each other's mirror image: the paper's cost and its assignment.

The paper maximises Σ p_ij a_ij over binary P with 1ᵀP ≤ 1ᵀ, P1 ≤ 1 and 1ᵀP1 = 2q; a_ij is a distance, so it is
minimised here. Without P = Pᵀ this is a k-cardinality assignment, whose relaxation is integral: a linear
assignment on a padded matrix solves it exactly. With P = Pᵀ, as a reflection is an involution, it is a matching
of q edges in a general graph, whose relaxation is not: an integer program, for small sets.
"""

import numpy as np
from jaxtyping import Float, Int, Real
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching
from scipy.spatial.distance import cdist

from symjax.errors import InvalidArgumentError, MatchingError
from symjax.geometry.checks import whole
from symjax.symhks.symmetric_matching import least_matching

SIGN_PENALTY = 1000.0
"""Cost b of pairing two points in the same nodal domains (the paper's number)."""

MAX_SYMMETRIC_POINTS = 300
"""Most keypoints for the symmetric program, whose size grows with their square: about a second at this one, up to ten
among many equal costs."""


def sign_penalty_cost(
    signatures: Float[np.ndarray, "a p"], signs: Real[np.ndarray, "a s"], *, penalty: float = SIGN_PENALTY
) -> Float[np.ndarray, "a a"]:
    """The paper's a_ij = ‖h_i − h_j‖₂ + ψ(‖s_i − s_j‖₂), with ψ(0) = b and ψ(t) = 0 for t > 0.

    Points with equal signs are likely neighbours and not mirror images. By the same formula the diagonal is b:
    a point is not its own mirror image.

    Args:
        signatures: heat kernel signatures h_i of the keypoints.
        signs: ±1, the signs s_i of the low eigenfunctions at the keypoints.
        penalty: b, which must exceed every distance between signatures.

    Raises:
        InvalidArgumentError: shapes, values that are not finite or not ±1, or a distance that reaches the
            penalty, so that the two could not be told apart.
    """
    h, s = np.asarray(signatures, float), np.asarray(signs, float)
    if h.ndim != 2 or s.ndim != 2 or len(h) != len(s) or 0 in h.shape + s.shape:
        raise InvalidArgumentError(
            f"signatures (a, p) and signs (a, s) need the same a >= 1 rows and a column; got {h.shape} and {s.shape}"
        )
    _refuse(~np.isfinite(h), "signatures", "not finite")
    _refuse(np.abs(s) != 1.0, "signs", "not +1 or -1 (take -1 where the eigenfunction is negative, else +1)")
    distance = cdist(h, h)
    if not distance.max() < penalty:
        raise InvalidArgumentError(
            f"signatures differ by up to {distance.max():.3g}, which the penalty {penalty:g} must exceed: "
            "scale the cloud to unit area or raise the penalty"
        )
    # Sums of ±1 are exact: s_i . s_j = s only for equal sign vectors.
    return distance + penalty * (s @ s.T == s.shape[1])


def assign_pairs(
    cost: Float[np.ndarray, "a a"], num_pairs: int, *, symmetric: bool = False, penalty: float = SIGN_PENALTY
) -> Int[np.ndarray, "q 2"]:
    """Pairs (i, j), i < j, no point in two of them, of least total cost, the cheapest first.

    By default the paper's program is solved exactly for 2q directed matches i -> j, and the mutual ones are kept,
    those with j -> i too: at most q pairs, fewer where points are matched in a ring or costs are equal, possibly
    none. With `symmetric` P = Pᵀ is imposed: exactly q pairs, of least total cost among all sets of q.

    Costs at or above `penalty`, infinite ones among them, and the diagonal are prohibited rather than dear: such
    a match is wrong by construction, and one that only fills up the number would be noise. Wherever 2q matches
    can be made without paying, the answer is the one of the paper's finite b if b exceeds the cost of all 2q.

    Args:
        cost: symmetric costs a_ij; set an entry (and its mirror) to infinity to prohibit a pair of your own.
        num_pairs: q, the number of pairs asked for.
        symmetric: solve the symmetric program, exactly, for at most `MAX_SYMMETRIC_POINTS` points.
        penalty: costs from here on are prohibited.

    Raises:
        InvalidArgumentError: a cost that is not square, not symmetric, NaN or −infinity; `num_pairs` < 1; a
            penalty that is not positive; too many points for `symmetric`.
        MatchingError: the allowed entries hold fewer matches than asked for (see `possible_pairs`).
    """
    allowed = _allowed_cost(cost, penalty)
    num_pairs = whole("num_pairs", num_pairs, 1)
    if symmetric:
        check_symmetric(len(allowed))
    possible = _num_matches(allowed) // 2
    if num_pairs > possible:
        raise MatchingError(
            f"{num_pairs} pairs asked for, but the allowed costs among {len(allowed)} points hold at most {possible}: "
            "ask for fewer pairs, use more keypoints, or compare the signs of more eigenfunctions"
        )
    if symmetric:
        pairs = least_matching(allowed, num_pairs)
    else:
        pairs = _mutual(least_assignment(allowed, 2 * num_pairs), len(allowed))
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0], allowed[pairs[:, 0], pairs[:, 1]]))]


def check_symmetric(num_points: int) -> None:
    """Refuses more points than the symmetric program is for.

    Raises:
        InvalidArgumentError: there are more than `MAX_SYMMETRIC_POINTS`.
    """
    if num_points > MAX_SYMMETRIC_POINTS:
        raise InvalidArgumentError(
            f"symmetric=True is for at most {MAX_SYMMETRIC_POINTS} points; got {num_points}: "
            "use fewer keypoints (num_keypoints) or symmetric=False"
        )


def possible_pairs(cost: Float[np.ndarray, "a a"], *, penalty: float = SIGN_PENALTY) -> int:
    """Largest `num_pairs` that `assign_pairs` can meet; an upper bound if `symmetric`.

    Raises:
        InvalidArgumentError: as `assign_pairs`.
    """
    return _num_matches(_allowed_cost(cost, penalty)) // 2


def least_assignment(cost: Float[np.ndarray, "a a"], num_matches: int) -> Int[np.ndarray, "k 2"]:
    """The k matches (row, column), no row and no column twice, of least total cost; infinite costs are prohibited.

    d = a − k dummy rows and as many dummy columns are free of charge, and a dummy never meets a dummy. The dummy
    rows then take d true columns and the dummy columns d true rows, which leaves exactly k true matches, and any
    k of them can be completed so (Dell'Amico and Martello, "The k-cardinality assignment problem", 1997).
    Memory: a matrix of (2a − k)².

    Args:
        cost: costs, without NaN; at least k matches must be possible.
        num_matches: k, from 1 to a.
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
    """The matches i -> j, i < j, that come with j -> i."""
    partner = np.full(num_points, -1)
    partner[matches[:, 0]] = matches[:, 1]
    i, j = matches.T
    return matches[(i < j) & (partner[j] == i)]


def _allowed_cost(cost: Float[np.ndarray, "a a"], penalty: float) -> Float[np.ndarray, "a a"]:
    """A checked copy of the costs, infinite on the diagonal and from the penalty on."""
    allowed = np.array(cost, float)
    if allowed.ndim != 2 or allowed.shape[0] != allowed.shape[1] or len(allowed) == 0:
        raise InvalidArgumentError(f"cost must be a square matrix, one row a keypoint; got shape {allowed.shape}")
    if not penalty > 0:
        raise InvalidArgumentError(f"penalty must be positive; got {penalty}")
    _refuse(np.isnan(allowed) | (allowed == -np.inf), "cost", "NaN or -infinity")
    _refuse(~np.isclose(allowed, allowed.T, rtol=1e-9, atol=0.0), "cost", "different from their mirror (j, i)")
    allowed[allowed >= penalty] = np.inf
    np.fill_diagonal(allowed, np.inf)
    return allowed


def _num_matches(cost: Float[np.ndarray, "a a"]) -> int:
    """Most finite entries with no row and no column twice."""
    return int(np.count_nonzero(maximum_bipartite_matching(csr_array(np.isfinite(cost))) >= 0))


def _refuse(bad: np.ndarray, name: str, fault: str) -> None:
    if bad.any():
        first = tuple(int(index) for index in np.argwhere(bad)[0])
        raise InvalidArgumentError(f"{np.count_nonzero(bad)} entries of {name} are {fault}, the first at {first}")
