"""The least-squares plane of pairs: the maximum-likelihood estimate of the paper (Eq. 2), corrected and as printed.

A NumPy implementation of its own, independent of `symjax.l2e.starts.initialisation.l2_plane`, so that the baselines do
not depend on our estimator.
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
    """Returns the plane that minimises Σ w ‖y − r(x)‖², where r is the reflection.

    With mid-points m and half differences h, the normal n is the eigenvector of the least eigenvalue of
    Σ (m − m̄)(m − m̄)ᵀ − Σ h hᵀ, and the offset is n · m̄. The paper prints H = Σ x yᵀ instead of this matrix, which is
    correct only if m̄ = 0; this function uses the symmetric part of H.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: weights of the pairs; None: all 1.
        as_printed: use the paper's H.

    Returns:
        Unit normal and offset.
    """
    w = np.ones(len(x)) if weights is None else weights
    mean = (w @ (x + y)) / (2 * w.sum())
    shift = np.zeros(3) if as_printed else mean
    H = (w[:, None] * (x - shift)).T @ (y - shift)
    normal = np.linalg.eigh(0.5 * (H + H.T))[1][:, 0]
    return normal, float(normal @ mean)
