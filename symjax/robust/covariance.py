"""Clustered covariance: standard errors where neighbouring residuals are no independent evidence."""

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane


def mirror_clusters(plane: Plane, points: Float[np.ndarray, "n 3"], cell: float) -> Int[np.ndarray, " n"]:
    """Labels of cells of the half space that the plane folds the cloud into: a point and its mirror image share one.

    Args:
        plane: the mirror.
        points: the cloud.
        cell: side of a cell.
    """
    height = np.asarray(plane.signed_distance(points))
    folded = points - (np.minimum(height, 0) * 2)[:, None] * plane.normal
    return np.unique(np.floor(folded / cell).astype(int), axis=0, return_inverse=True)[1].ravel()


def clustered_covariance(
    gradients: Float[np.ndarray, "n 3"], hessians: Float[np.ndarray, "n 3 3"], cluster: Int[np.ndarray, " n"]
) -> Float[np.ndarray, "3 3"]:
    """Sandwich covariance of an M-estimate by the jackknife over clusters (CR3), one Newton step for each left out.

    With few clusters of unequal weight the plain sandwich H⁻¹ Σ g gᵀ H⁻¹ is too small.
    MacKinnon, Nielsen, Webb, "Cluster-robust inference: a guide to empirical practice", J. Econometrics 232 (2023).

    Args:
        gradients: every residual's share of the criterion's gradient.
        hessians: every residual's share of its expected Hessian.
        cluster: label of every residual.
    """
    count = int(cluster.max()) + 1
    gradient = np.stack([np.bincount(cluster, column, count) for column in gradients.T], axis=1)
    entries = [np.bincount(cluster, entry, count) for entry in hessians.reshape(-1, 9).T]
    hessian = np.stack(entries, axis=1).reshape(-1, 3, 3)
    used = (gradient != 0).any(axis=1)
    step = np.matmul(np.linalg.pinv(hessian.sum(axis=0) - hessian[used]), gradient[used][:, :, None])[:, :, 0]
    return step.T @ step * (1 - 1 / max(len(step), 2))
