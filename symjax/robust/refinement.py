"""The last digits of a plane: L2E with point-to-surface residuals and exact neighbours, and its standard errors.

The mirror image of a random sample has no twin in it: distances between points floor the accuracy at the sample's
spacing. The residual here is the height of a mirror image above the quadric patch of its partner; all else is the
paper's estimator, ψ = −σ² log Σ wᵢ exp(−rᵢ²/2σ²) minimised by Riemannian BFGS on S² × R.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.base import Minimum
from symjax.l2e.solvers.rbfgs import minimize
from symjax.robust.quadrics import Patches
from symjax.robust.surface import Surface

LEAST_BUCKET = 2048
"""Residuals are padded to this or the next power of two, so that few sizes are compiled."""

ROUNDS = 5
"""Times that the partners are looked for anew, each time with the σ of the last residuals."""

LEAST_SIGMA = 0.02
"""Least scale of the residual in spacings. Patches of flat and round parts fit far better than this, but it is the
others that fix the plane of an object that is mostly round, and they must not count as outliers."""

SIGMA_FACTOR = 2.0
"""σ over the residuals' own scale: L2E then loses little of the efficiency of least squares."""

SHARED = 3.0
"""Side of the cells that share their errors, in reaches of a patch: neighbouring residuals and those of the two
directions of a pair have points in common, so that they are no independent evidence."""

INFLATION = 1.4
"""Variance over what the sandwich gives: it is made for fixed pairs, and partners change as the plane moves. Chosen on
generated noisy clouds; `experiments.run coverage` prints the share of regions that hold the true plane with it."""


class Residuals(NamedTuple):
    """Mirror images and the patches that they should lie on.

    Attributes:
        x: the points that are mirrored.
        origin: origin of each one's patch.
        axes: its axes.
        coefficients: its coefficients.
        weight: how much each counts; 0 in padding.
    """

    x: Float[Array, "m 3"]
    origin: Float[Array, "m 3"]
    axes: Float[Array, "m 3 3"]
    coefficients: Float[Array, "m 6"]
    weight: Float[Array, "m"]


class Polished(NamedTuple):
    """A plane after the last digits.

    Attributes:
        plane: the plane.
        covariance: of the normal's turn along the two tangents, and of the offset.
        tangents: in rows.
        sigma: scale of the residual.
        solution: how the last solve ended.
    """

    plane: Plane
    covariance: Float[np.ndarray, "3 3"]
    tangents: Float[np.ndarray, "2 3"]
    sigma: float
    solution: Minimum


def heights(z: Float[Array, "4"], data: Residuals) -> Float[Array, "m"]:
    """Heights of the mirror images above the patches at the plane z = (v, ω)."""
    v, omega = z[:3], z[3]
    x = data.x
    along = 2 * (x[:, 0] * v[0] + x[:, 1] * v[1] + x[:, 2] * v[2] - omega)
    offset = [x[:, k] - along * v[k] - data.origin[:, k] for k in range(3)]
    u, w, height = (sum(offset[k] * data.axes[:, i, k] for k in range(3)) for i in range(3))
    c = [data.coefficients[:, k] for k in range(6)]
    return height - (c[0] + c[1] * u + c[2] * w + c[3] * u * u + c[4] * u * w + c[5] * w * w)


def _psi(z: Float[Array, "4"], sigma: Float[Array, ""], data: Residuals) -> Float[Array, ""]:
    kernel = jnp.sum(data.weight * jnp.exp(-0.5 * (heights(z, data) / sigma) ** 2))
    return -(sigma**2) * jnp.log(kernel / jnp.sum(data.weight) + 1e-300)


@jax.jit
def _solve(z: Float[Array, "4"], sigma: Float[Array, ""], data: Residuals) -> tuple[Minimum, Float[Array, "m"]]:
    tol = 1e-4 * sigma
    minimum = minimize(lambda z: _psi(z, sigma, data), z, manifold=SPHERE_LINE, max_steps=50, tol=tol)
    return minimum, heights(minimum.point, data)


@jax.jit
def _slopes(z: Float[Array, "4"], data: Residuals) -> Float[Array, "m 3"]:
    """Derivative of every height in the tangent chart at z."""
    basis = SPHERE_LINE.basis(z)
    return jax.jacfwd(lambda t: heights(SPHERE_LINE.retract(z, basis @ t), data))(jnp.zeros(3, z.dtype))


def polish(plane: Plane, surface: Surface, around: Patches) -> Polished:
    """Moves a plane to the optimum of the point-to-surface L2E criterion, its partners looked for anew in every round.

    Args:
        plane: a plane within the reach of the surface's tolerance.
        surface: the cloud.
        around: its patches.
    """
    z = np.append(plane.normal, plane.offset)
    sigma = 2 * surface.tolerance
    with jax.enable_x64(True):
        for _ in range(ROUNDS):
            data, weight = _paired(z, surface, around)
            solution, residual = _solve(jnp.asarray(z), jnp.asarray(sigma), data)
            z, residual = np.asarray(solution.point), np.asarray(residual)[: len(weight)]
            last, sigma = sigma, min(sigma, max(_scale(residual, weight, sigma), LEAST_SIGMA * surface.spacing))
        flat = data._replace(coefficients=jnp.zeros_like(data.coefficients))
        slopes, mean_slopes = (np.asarray(_slopes(jnp.asarray(z), patch))[: len(weight)] for patch in (data, flat))
        basis = np.asarray(SPHERE_LINE.basis(jnp.asarray(z)))
    at = Plane(z[:3], z[3])
    cell = SHARED * float(np.median(around.reach))
    kernel = weight * np.exp(-0.5 * (residual / last) ** 2)
    covariance = clustered_covariance(
        (kernel * residual)[:, None] * slopes,
        # a patch's slope is noisy, and changes as the plane moves on to other partners: the normal's is the mean
        (kernel * (1 - (residual / last) ** 2))[:, None, None] * mean_slopes[:, :, None] * mean_slopes[:, None],
        _clusters(at, surface.points, cell),
    )
    return Polished(at, INFLATION * covariance, basis[:3, :2].T, last, solution)


def _paired(z: Float[np.ndarray, "4"], surface: Surface, around: Patches) -> tuple[Residuals, Float[np.ndarray, "n"]]:
    """Every point with its partner's patch, and its weight; those whose partner is far, or faces elsewhere, count
    nothing.
    """
    v, omega = z[:3], z[3]
    height = surface.points @ v - omega
    image = surface.points - 2 * height[:, None] * v
    distance, partner = surface.tree.query(image, workers=-1)
    facing = surface.normals - 2 * (surface.normals @ v)[:, None] * v
    cosine = np.abs((facing * surface.normals[partner]).sum(axis=1))
    weight = cosine**2
    weight *= 1 - np.exp(-2 * (height / surface.spacing) ** 2)
    weight *= (distance < around.reach[partner]) & ~surface.rim[partner]
    columns = (surface.points, around.origin[partner], around.axes[partner], around.coefficients[partner], weight)
    return _padded(*columns), weight


def _padded(*columns: Float[np.ndarray, "n ..."]) -> Residuals:
    count = len(columns[0])
    extra = max(LEAST_BUCKET, 1 << (count - 1).bit_length()) - count
    return Residuals(*(jnp.asarray(np.pad(column, ((0, extra), *[(0, 0)] * (column.ndim - 1)))) for column in columns))


def _scale(residual: Float[np.ndarray, "n"], weight: Float[np.ndarray, "n"], sigma: float) -> float:
    """σ for the next round: a multiple of the residuals' median size, the outliers' left out."""
    inlier = (weight > 0) & (np.abs(residual) < 3 * sigma)
    if not inlier.any():
        return sigma
    return SIGMA_FACTOR * 1.4826 * float(np.median(np.abs(residual[inlier])))


def _clusters(plane: Plane, points: Float[np.ndarray, "n 3"], cell: float) -> Int[np.ndarray, "n"]:
    """Cells of the half space that the plane folds the cloud into: a point and its mirror image share one."""
    height = np.asarray(plane.signed_distance(points))
    folded = points - (np.minimum(height, 0) * 2)[:, None] * plane.normal
    return np.unique(np.floor(folded / cell).astype(int), axis=0, return_inverse=True)[1].ravel()


def clustered_covariance(
    gradients: Float[np.ndarray, "n 3"], hessians: Float[np.ndarray, "n 3 3"], cluster: Int[np.ndarray, "n"]
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
