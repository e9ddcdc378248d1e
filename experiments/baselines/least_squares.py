"""The least-squares plane of given pairs: the maximum-likelihood estimate of Eq. 2 of the paper, printed and corrected.

In NumPy and apart from `symjax.l2e.starts.initialisation.l2_plane`, so that the baselines stand on nothing of ours.
"""

import numpy as np
from jaxtyping import Float


def least_squares(
    x: Float[np.ndarray, "n 3"],
    y: Float[np.ndarray, "n 3"],
    weights: Float[np.ndarray, " n"] | None = None,
    *,
    as_printed: bool = False,
) -> tuple[Float[np.ndarray, " 3"], float]:
    """The plane that minimises Σ w ‖y − r(x)‖².

    With mid-points m and half differences h: the least eigenvector of Σ (m − m̄)(m − m̄)ᵀ − Σ h hᵀ, and n · m̄. The
    paper prints H = Σ x yᵀ, right only where m̄ = 0; the symmetric part of it is taken.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: of the pairs.
        as_printed: take the paper's H.

    Returns:
        Unit normal and offset.
    """
    w = np.ones(len(x)) if weights is None else weights
    mean = (w @ (x + y)) / (2 * w.sum())
    shift = np.zeros(3) if as_printed else mean
    H = (w[:, None] * (x - shift)).T @ (y - shift)
    normal = np.linalg.eigh(0.5 * (H + H.T))[1][:, 0]
    return normal, float(normal @ mean)
