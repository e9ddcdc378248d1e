"""Covariance: standard errors of a fit whose neighbouring residuals are not independent."""

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane


def mirror_clusters(plane: Plane, points: Float[np.ndarray, "n 3"], cell: float) -> Int[np.ndarray, " n"]:
    """Divides the points into clusters, such that a point and its mirror image share one.

    The plane folds space onto one half, which is divided into cubic cells.

    Args:
        plane: the mirror plane.
        points: the points.
        cell: side of a cell, in the units of the points.

    Returns:
        The label of the cluster of each point, counted from 0.
    """
    height = np.asarray(plane.signed_distance(points))
    folded = points - (np.minimum(height, 0) * 2)[:, None] * plane.normal
    return np.unique(np.floor(folded / cell).astype(int), axis=0, return_inverse=True)[1].ravel()


def clustered_covariance(
    gradients: Float[np.ndarray, "n 3"], hessians: Float[np.ndarray, "n 3 3"], cluster: Int[np.ndarray, " n"]
) -> Float[np.ndarray, "3 3"]:
    """Computes the covariance of an M-estimate by the jackknife over clusters (CR3).

    Each cluster is left out in turn, and one Newton step estimates how far the optimum moves. The plain sandwich
    H⁻¹ Σ g gᵀ H⁻¹ is too small if there are few clusters of unequal weight.
    MacKinnon, Nielsen, Webb, "Cluster-robust inference: a guide to empirical practice", J. Econometrics 232 (2023).

    Args:
        gradients: contribution of each residual to the gradient of the criterion.
        hessians: contribution of each residual to its expected Hessian.
        cluster: label of the cluster of each residual.
    """
    count = int(cluster.max()) + 1
    gradient = np.stack([np.bincount(cluster, column, count) for column in gradients.T], axis=1)
    entries = [np.bincount(cluster, entry, count) for entry in hessians.reshape(-1, 9).T]
    hessian = np.stack(entries, axis=1).reshape(-1, 3, 3)
    used = (gradient != 0).any(axis=1)
    steps = np.matmul(np.linalg.pinv(hessian.sum(axis=0) - hessian[used]), gradient[used][:, :, None])[:, :, 0]
    covariance: Float[np.ndarray, "3 3"] = steps.T @ steps * (1 - 1 / max(len(steps), 2))
    return covariance
