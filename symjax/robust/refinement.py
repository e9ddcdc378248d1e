"""Refinement of a plane: L2E with point-to-surface residuals and exact neighbours, and its standard errors.

The mirror image of a random sample has no twin in it: distances between points floor the accuracy at the sample's
spacing. The residual here is the height of a mirror image above the quadric of its partner; the rest is the paper's
estimator, ψ = −σ² log Σ wᵢ exp(−rᵢ²/2σ²) minimised by Riemannian BFGS on S² × R.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity
from symjax.geometry.uncertainty import Uncertainty
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.pairs.padded import padded_size
from symjax.l2e.solvers.base import Minimum
from symjax.l2e.solvers.rbfgs import minimise
from symjax.l2e.status import Status
from symjax.robust.covariance import clustered_covariance, mirror_clusters
from symjax.robust.quadrics import Quadrics
from symjax.robust.surface import Surface

LEAST_SIZE = 2048
"""Residuals are padded to this number or the next power of two, so that few sizes are compiled."""

ROUNDS = 5
"""Searches for partners, each followed by a solve with the σ of the last residuals."""

LEAST_SIGMA = 0.02
"""Least scale of the residual in spacings. Quadrics of flat and round parts fit far better than this, but the other
parts fix the plane of an object that is mostly round, and they must not count as outliers."""

SIGMA_FACTOR = 2.0
"""σ over the residuals' own scale: L2E then loses little of the efficiency of least squares."""

CLUSTER_SIDE = 3.0
"""Side of the cells that share their errors, in reaches of a quadric: neighbouring residuals, and those of the two
directions of a pair, have points in common and are no independent evidence."""

INFLATION = 1.4
"""Variance over what the sandwich gives: it is made for fixed pairs, and partners change as the plane moves. Chosen on
generated noisy clouds; `experiments.run coverage` prints the share of regions that hold the true plane with it."""


class Residuals(NamedTuple):
    """Mirror images and the quadrics that they should lie on.

    Attributes:
        x: the points that are mirrored.
        frames: frame of each one's quadric.
        coefficients: its coefficients.
        weight: how much each counts; 0 in padding.
    """

    x: Float[Array, "m 3"]
    frames: Similarity
    coefficients: Float[Array, "m 6"]
    weight: Float[Array, " m"]


class Refinement(NamedTuple):
    """A refined plane.

    Attributes:
        plane: the plane.
        uncertainty: of the plane, about the origin.
        sigma: scale of the residual.
        converged: whether the last solve converged.
        message: how it ended, as a sentence.
    """

    plane: Plane
    uncertainty: Uncertainty
    sigma: float
    converged: bool
    message: str


def heights(z: Float[Array, " 4"], data: Residuals) -> Float[Array, " m"]:
    """Heights of the mirror images above the quadrics at the plane z = (v, ω).

    Column by column: with `Plane.reflect` and `Similarity.points`, whose results are stacked, a solve takes 2.5 times
    as long on a CPU.
    """
    v, omega = z[:3], z[3]
    x = data.x
    along = 2 * (x[:, 0] * v[0] + x[:, 1] * v[1] + x[:, 2] * v[2] - omega)
    image = [x[:, k] - along * v[k] for k in range(3)]
    axes, shift = jnp.asarray(data.frames.rotation), jnp.asarray(data.frames.shift)
    u, w, height = (sum(image[k] * axes[:, i, k] for k in range(3)) + shift[:, i] for i in range(3))
    c = [data.coefficients[:, k] for k in range(6)]
    return height - (c[0] + c[1] * u + c[2] * w + c[3] * u * u + c[4] * u * w + c[5] * w * w)


def _psi(z: Float[Array, " 4"], sigma: Float[Array, ""], data: Residuals) -> Float[Array, ""]:
    kernel = jnp.sum(data.weight * jnp.exp(-0.5 * (heights(z, data) / sigma) ** 2))
    return -(sigma**2) * jnp.log(kernel / jnp.sum(data.weight) + 1e-300)


@jax.jit
def _solve(z: Float[Array, " 4"], sigma: Float[Array, ""], data: Residuals) -> tuple[Minimum, Float[Array, " m"]]:
    tol = 1e-4 * sigma
    minimum = minimise(lambda z: _psi(z, sigma, data), z, manifold=SPHERE_LINE, max_steps=50, tol=tol)
    return minimum, heights(minimum.point, data)


@jax.jit
def _slopes(z: Float[Array, " 4"], data: Residuals) -> Float[Array, "m 3"]:
    """Derivative of every height in the tangent chart at z."""
    basis = SPHERE_LINE.basis(z)
    return jax.jacfwd(lambda t: heights(SPHERE_LINE.retract(z, basis @ t), data))(jnp.zeros(3, z.dtype))


def refine(plane: Plane, surface: Surface, quadrics: Quadrics) -> Refinement:
    """Moves a plane to the optimum of the point-to-surface L2E criterion; every round finds the partners anew.

    Args:
        plane: a plane within the reach of the surface's tolerance.
        surface: the cloud.
        quadrics: of the surface.
    """
    z = np.append(plane.normal, plane.offset)
    sigma = 2 * surface.tolerance
    with jax.enable_x64(True):
        for _ in range(ROUNDS):
            data, weight = _paired(z, surface, quadrics)
            solution, residual = _solve(jnp.asarray(z), jnp.asarray(sigma), data)
            z, residual = np.asarray(solution.point), np.asarray(residual)[: len(weight)]
            last, sigma = sigma, min(sigma, max(_scale(residual, weight, sigma), LEAST_SIGMA * surface.spacing))
        flat = data._replace(coefficients=jnp.zeros_like(data.coefficients))
        slopes, mean_slopes = (np.asarray(_slopes(jnp.asarray(z), of))[: len(weight)] for of in (data, flat))
        basis = np.asarray(SPHERE_LINE.basis(jnp.asarray(z)))
        status = Status(int(solution.status))
    refined = Plane(z[:3], z[3])
    kernel = weight * np.exp(-0.5 * (residual / last) ** 2)
    covariance = clustered_covariance(
        (kernel * residual)[:, None] * slopes,
        # a quadric's slope is noisy, and changes as the plane moves on to other partners: the normal's is the mean
        (kernel * (1 - (residual / last) ** 2))[:, None, None] * mean_slopes[:, :, None] * mean_slopes[:, None],
        mirror_clusters(refined, surface.points, CLUSTER_SIDE * float(np.median(quadrics.reach))),
    )
    uncertainty = Uncertainty(INFLATION * covariance, basis[:3, :2].T, np.zeros(3))
    return Refinement(refined, uncertainty, last, status == Status.SUCCESSFUL, status.sentence)


def _paired(
    z: Float[np.ndarray, " 4"], surface: Surface, quadrics: Quadrics
) -> tuple[Residuals, Float[np.ndarray, " n"]]:
    """Every point with its partner's quadric, and its weight: 0 if the partner is far or faces another way."""
    plane = Plane(z[:3], z[3])
    height = np.asarray(plane.signed_distance(surface.points))
    distance, partner = surface.tree.query(np.asarray(plane.reflect(surface.points)), workers=-1)
    facing = np.asarray(plane.reflect_directions(surface.normals))
    cosine = np.abs((facing * surface.normals[partner]).sum(axis=1))
    weight = cosine**2
    weight *= 1 - np.exp(-2 * (height / surface.spacing) ** 2)
    weight *= (distance < quadrics.reach[partner]) & ~surface.boundary[partner]
    return _padded(surface.points, quadrics.frames_of(partner), quadrics.coefficients[partner], weight), weight


def _padded(
    x: Float[np.ndarray, "n 3"],
    frames: Similarity,
    coefficients: Float[np.ndarray, "n 6"],
    weight: Float[np.ndarray, " n"],
) -> Residuals:
    extra = padded_size(len(x), LEAST_SIZE) - len(x)

    def padded(column: Float[np.ndarray, "n ..."]) -> Float[Array, "m ..."]:
        return jnp.asarray(np.pad(column, ((0, extra), *[(0, 0)] * (column.ndim - 1))))

    rotation, shift = padded(np.asarray(frames.rotation)), padded(np.asarray(frames.shift))
    return Residuals(padded(x), Similarity(1.0, rotation, shift), padded(coefficients), padded(weight))


def _scale(residual: Float[np.ndarray, " n"], weight: Float[np.ndarray, " n"], sigma: float) -> float:
    """σ for the next round: a multiple of the residuals' median size, without the outliers."""
    inlier = (weight > 0) & (np.abs(residual) < 3 * sigma)
    if not inlier.any():
        return sigma
    return SIGMA_FACTOR * 1.4826 * float(np.median(np.abs(residual[inlier])))
