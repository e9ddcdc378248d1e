"""One-to-one matching of answers to truths, greedily."""

import numpy as np
from jaxtyping import Float, Int


def by_rank(cost: Float[np.ndarray, "k t"]) -> Int[np.ndarray, "k"]:
    """Every answer in turn, best first, takes the free truth of least cost.

    Args:
        cost: of answer k and truth t; infinite where they do not match.

    Returns:
        The truth of each answer, −1 where it has none.
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


def by_cost(cost: Float[np.ndarray, "k t"]) -> Float[np.ndarray, "m"]:
    """The cheapest pair first, then the cheapest of what is left, until answers or truths are used up.

    A limit on the cost only cuts this sequence short: one matching serves all limits.

    Returns:
        The costs of the pairs, rising.
    """
    left = np.array(cost, float)
    costs = np.empty(min(cost.shape))
    for m in range(len(costs)):
        k, t = np.unravel_index(left.argmin(), left.shape)
        costs[m] = left[k, t]
        left[k, :] = left[:, t] = np.inf
    return costs
