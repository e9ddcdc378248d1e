"""Refinement: moves a plane to the optimum of the L2E criterion of exact point-to-surface residuals.

In a randomly sampled cloud, no point lies exactly at the mirror image of another. Distances between points would
therefore limit the accuracy to the spacing. Here the residual rᵢ is the height of a mirror image above the quadric of
its partner, the surface point nearest to it. The rest is the paper's estimator: ψ = −σ² log Σ wᵢ exp(−rᵢ²/2σ²),
minimised by Riemannian BFGS on S² × R.
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

MIN_SIZE = 2048
"""Correspondences are padded to this number or to the next power of two, so that few sizes are compiled."""

ROUNDS = 5
"""Number of rounds. Each finds the partners anew and solves with the σ that follows from the last residuals."""

MIN_SIGMA = 0.02
"""Minimum σ, in spacings. The residuals of flat and round parts are far smaller than this. The plane of a mostly round
object is determined by its other parts, and these must not count as outliers."""

SIGMA_FACTOR = 2.0
"""Ratio of σ to the standard deviation of the residuals. L2E then loses little of the efficiency of least squares."""

CLUSTER_SIDE = 3.0
"""Side of the cells whose residuals form a cluster, in radii of a quadric. Neighbouring residuals, and the two
residuals of a pair, have points in common and are not independent."""

INFLATION = 1.4
"""Factor on the variance of the sandwich formula, which assumes fixed pairs, whereas the partners change as the plane
moves. Chosen on generated noisy clouds; `experiments.run coverage` prints the fraction of confidence regions that
contain the true plane."""


class Correspondences(NamedTuple):
    """What the residuals are computed from: points, and the quadrics of their partners.

    Attributes:
        x: the points that are reflected.
        frames: frames of the partners' quadrics.
        coefficients: coefficients of the partners' quadrics.
        weight: weights of the residuals; 0 in the padding.
    """

    x: Float[Array, "m 3"]
    frames: Similarity
    coefficients: Float[Array, "m 6"]
    weight: Float[Array, " m"]


class Refinement(NamedTuple):
    """A refined plane.

    Attributes:
        plane: the plane.
        uncertainty: uncertainty of the plane, about the origin.
        sigma: scale σ of the residuals in the last round.
        converged: whether the solver converged in the last round.
        message: how it ended, as a sentence.
    """

    plane: Plane
    uncertainty: Uncertainty
    sigma: float
    converged: bool
    message: str


def heights(z: Float[Array, " 4"], data: Correspondences) -> Float[Array, " m"]:
    """Returns the residuals for the plane z = (v, ω): the heights of the mirror images above the quadrics.

    It works column by column: with `Plane.reflect` and `Similarity.points`, which stack their results, a solve takes
    2.5 times as long on a CPU.
    """
    v, omega = z[:3], z[3]
    x = data.x
    along = 2 * (x[:, 0] * v[0] + x[:, 1] * v[1] + x[:, 2] * v[2] - omega)
    image = [x[:, k] - along * v[k] for k in range(3)]
    axes, shift = jnp.asarray(data.frames.rotation), jnp.asarray(data.frames.shift)
    u, w, height = (sum(image[k] * axes[:, i, k] for k in range(3)) + shift[:, i] for i in range(3))
    c = [data.coefficients[:, k] for k in range(6)]
    residual: Float[Array, " m"] = height - (c[0] + c[1] * u + c[2] * w + c[3] * u * u + c[4] * u * w + c[5] * w * w)
    return residual


def _psi(z: Float[Array, " 4"], sigma: Float[Array, ""], data: Correspondences) -> Float[Array, ""]:
    """Returns the L2E criterion ψ for the plane z = (v, ω)."""
    kernel = jnp.sum(data.weight * jnp.exp(-0.5 * (heights(z, data) / sigma) ** 2))
    return -(sigma**2) * jnp.log(kernel / jnp.sum(data.weight) + 1e-300)


@jax.jit
def _solve(z: Float[Array, " 4"], sigma: Float[Array, ""], data: Correspondences) -> tuple[Minimum, Float[Array, " m"]]:
    tol = 1e-4 * sigma
    minimum = minimise(lambda z: _psi(z, sigma, data), z, manifold=SPHERE_LINE, max_steps=50, tol=tol)
    return minimum, heights(minimum.point, data)


@jax.jit
def _jacobian(z: Float[Array, " 4"], data: Correspondences) -> Float[Array, "m 3"]:
    """Returns the derivative of each residual with respect to two turns of the normal and the offset."""
    basis = SPHERE_LINE.basis(z)
    derivative = jax.jacfwd(lambda t: heights(SPHERE_LINE.retract(z, basis @ t), data))
    jacobian: Float[Array, "m 3"] = derivative(jnp.zeros(3, z.dtype))
    return jacobian


def refine(plane: Plane, surface: Surface, quadrics: Quadrics) -> Refinement:
    """Moves a plane to the optimum of the L2E criterion of point-to-surface residuals.

    Args:
        plane: a plane that reflects the cloud to within about the surface's tolerance.
        surface: the surface.
        quadrics: the quadrics of the surface.

    Returns:
        The refined plane with its standard errors.
    """
    z = np.append(plane.normal, plane.offset)
    sigma = 2 * surface.tolerance
    with jax.enable_x64(True):
        for _ in range(ROUNDS):
            data, weight = _correspondences(z, surface, quadrics)
            solution, residual = _solve(jnp.asarray(z), jnp.asarray(sigma), data)
            z, residual = np.asarray(solution.point), np.asarray(residual)[: len(weight)]
            last_sigma = sigma
            sigma = min(sigma, max(_next_sigma(residual, weight, sigma), MIN_SIGMA * surface.spacing))
        flat = data._replace(coefficients=jnp.zeros_like(data.coefficients))
        jacobian, flat_jacobian = (np.asarray(_jacobian(jnp.asarray(z), of))[: len(weight)] for of in (data, flat))
        basis = np.asarray(SPHERE_LINE.basis(jnp.asarray(z)))
        status = Status(int(solution.status))
    refined = Plane(z[:3], z[3])
    kernel = weight * np.exp(-0.5 * (residual / last_sigma) ** 2)
    gradients = (kernel * residual)[:, None] * jacobian
    # The slope of a quadric is noisy and changes with the partner as the plane moves. The slope of the tangent plane is
    # its mean, and so gives the expected Hessian.
    curvature = kernel * (1 - (residual / last_sigma) ** 2)
    hessians = curvature[:, None, None] * flat_jacobian[:, :, None] * flat_jacobian[:, None]
    clusters = mirror_clusters(refined, surface.points, CLUSTER_SIDE * float(np.median(quadrics.radius)))
    covariance = clustered_covariance(gradients, hessians, clusters)
    uncertainty = Uncertainty(INFLATION * covariance, basis[:3, :2].T, np.zeros(3))
    return Refinement(refined, uncertainty, last_sigma, status == Status.SUCCESSFUL, status.sentence)


def _correspondences(
    z: Float[np.ndarray, " 4"], surface: Surface, quadrics: Quadrics
) -> tuple[Correspondences, Float[np.ndarray, " n"]]:
    """Finds the partner of every point; returns the correspondences, padded, and their weights without the padding.

    The weight is 0 if the partner is far or on the boundary. It is low if the normals disagree, or if the point lies
    near the plane.
    """
    plane = Plane(z[:3], z[3])
    height = np.asarray(plane.signed_distance(surface.points))
    distance, partner = surface.tree.query(np.asarray(plane.reflect(surface.points)), workers=-1)
    reflected = np.asarray(plane.reflect_directions(surface.normals))
    cosine = np.abs((reflected * surface.normals[partner]).sum(axis=1))
    weight = cosine**2
    weight *= 1 - np.exp(-2 * (height / surface.spacing) ** 2)
    weight *= (distance < quadrics.radius[partner]) & ~surface.boundary[partner]
    return _padded(surface.points, quadrics.frames_of(partner), quadrics.coefficients[partner], weight), weight


def _padded(
    x: Float[np.ndarray, "n 3"],
    frames: Similarity,
    coefficients: Float[np.ndarray, "n 6"],
    weight: Float[np.ndarray, " n"],
) -> Correspondences:
    """Pads every array with zeros, so that few sizes are compiled."""
    extra = padded_size(len(x), MIN_SIZE) - len(x)

    def padded(column: Float[np.ndarray, "n ..."]) -> Float[Array, "m ..."]:
        return jnp.asarray(np.pad(column, ((0, extra), *[(0, 0)] * (column.ndim - 1))))

    rotation, shift = padded(np.asarray(frames.rotation)), padded(np.asarray(frames.shift))
    return Correspondences(padded(x), Similarity(1.0, rotation, shift), padded(coefficients), padded(weight))


def _next_sigma(residual: Float[np.ndarray, " n"], weight: Float[np.ndarray, " n"], sigma: float) -> float:
    """Returns σ for the next round: SIGMA_FACTOR times the robust standard deviation of the residuals below 3σ."""
    inlier = (weight > 0) & (np.abs(residual) < 3 * sigma)
    if not inlier.any():
        return sigma
    return SIGMA_FACTOR * 1.4826 * float(np.median(np.abs(residual[inlier])))
