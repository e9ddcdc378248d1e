"""Standard errors of a fit, from the sandwich covariance of the L2E estimate."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.l2e.fit import WEIGHT_TO_INLIER_FRACTION, Fit
from symjax.l2e.jax_config import jit, keep_float64
from symjax.l2e.manifolds import SPHERE_LINE, tangent_basis
from symjax.l2e.objective import squared_residuals
from symjax.l2e.pairs.arguments import Points, Weights
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs


class StandardErrors(NamedTuple):
    """Standard errors of a fit.

    Attributes:
        plane: uncertainty of the plane: its covariance, standard errors and confidence regions.
        sigma: standard error of the estimated σ, in the units of the points; 0 if σ was given.
        inlier_fraction: standard error of `Fit.inlier_fraction`.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.4)
        >>> fit = symjax.fit_plane(pairs.x, pairs.y, 0.01)
        >>> errors = symjax.standard_errors(fit, pairs.x, pairs.y)
        >>> print(f"inlier fraction {fit.inlier_fraction:.2f} ± {errors.inlier_fraction:.2f}")
        inlier fraction 0.63 ± 0.07
    """

    plane: Uncertainty
    sigma: float
    inlier_fraction: float


@keep_float64
def standard_errors(
    fit: Fit,
    x: Points,
    y: Points,
    *,
    weights: Weights | None = None,
) -> StandardErrors:
    """Computes the standard errors of a fit by the sandwich formula A⁻¹BA⁻¹ of M-estimators (Godambe).

    A is the Hessian of the partial-density criterion, and B the sum of the outer products of the pairs' gradients. The
    parameters are the plane in its tangent chart, log σ (if it was estimated) and the inlier fraction ρ. The formula
    assumes independent pairs. The standard errors are too small if neighbouring pairs have correlated errors, or if a
    pair is listed twice, from either end.

    Args:
        fit: one fit, from `fit_plane` or `fit_global`.
        x: one end of every pair that was fitted, in the same unit.
        y: the other end.
        weights: weights of the pairs in that fit.

    Returns:
        The standard errors.

    Raises:
        InvalidArgumentError: if `fit` is a batch of fits.
        SymjaxError: if the pairs or weights are invalid, see `fit_plane`.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.4)
        >>> fit = symjax.fit_plane(pairs.x, pairs.y, 0.01)
        >>> errors = symjax.standard_errors(fit, pairs.x, pairs.y)
        >>> print(f"{errors.plane.normal_degrees:.2f} degrees, offset {errors.plane.offset:.4f}")
        0.20 degrees, offset 0.0008
    """
    if shape := np.shape(fit.loss):
        raise InvalidArgumentError(f"fit is a batch of fits of shape {shape}: pass one fit at a time")
    pairs = pad_pairs(x, y, weights)
    centre, covariance = (np.asarray(part, float) for part in _sandwich(fit, pairs))
    tangents = np.asarray(tangent_basis(jnp.asarray(fit.plane.normal))).T
    variances = np.diag(covariance)
    plane = Uncertainty(covariance[:3, :3], tangents, centre)
    return StandardErrors(plane, float(fit.sigma) * float(np.sqrt(variances[3])), float(np.sqrt(variances[4])))


@jit()
def _sandwich(fit: Fit, pairs: PaddedPairs) -> tuple[Float[Array, " 3"], Float[Array, "5 5"]]:
    """Computes the centre of the inliers, and the covariance of (two rotations, offset there, log σ, ρ)."""
    x, y, weights, to_given = normalise_pairs(pairs.x, pairs.y, pairs.weights)
    normal, offset, sigma = (jnp.asarray(part, x.dtype) for part in (*fit.plane, fit.sigma))
    v, omega = (jnp.asarray(part) for part in to_given.inverse().plane(Plane(normal, offset)))
    sigma = sigma / to_given.scale
    kernel = weights * jnp.exp(-squared_residuals(v, omega, x, y) / (2 * sigma**2))
    # the stationary point of the criterion, not clipped to 1 like `Fit.inlier_fraction`
    rho = WEIGHT_TO_INLIER_FRACTION * jnp.sum(kernel) / jnp.sum(weights)
    point = jnp.concatenate([v, jnp.stack([omega, jnp.log(sigma), rho])])
    centre = jnp.sum(kernel[:, None] * 0.5 * (x + y), axis=0) / jnp.sum(kernel)

    def terms(t: Float[Array, " 5"]) -> Float[Array, " n"]:
        """Computes every pair's term ρ²(4πσ²)^{−3/2} − 2ρ g(r), divided by the constant (2πσ̂²)^{−3/2}."""
        basis = SPHERE_LINE.basis(point)
        moved = SPHERE_LINE.retract(point, jnp.sum(basis * t[None, :], axis=1))
        # rotate about the centre of the inliers, where the offset is least correlated with the rotation
        offset = jnp.sum((moved[:3] - v) * centre) + moved[3]
        scale = jnp.exp(moved[4])
        kernel = jnp.exp(-squared_residuals(moved[:3], offset, x, y) / (2 * scale**2))
        rho = moved[5]
        return (sigma / scale) ** 3 * (rho**2 * 2**-1.5 - 2 * rho * kernel)

    origin = jnp.zeros(5, x.dtype)
    free = jnp.stack([jnp.ones((), bool)] * 3 + [fit.sigma_estimated, jnp.ones((), bool)])
    gradients = jnp.where(free[None, :], weights[:, None] * jax.jacfwd(terms)(origin), 0)
    hessian = jax.hessian(lambda t: jnp.sum(weights * terms(t)))(origin)
    both = free[:, None] & free[None, :]
    bread = jnp.linalg.inv(jnp.where(both, hessian, jnp.eye(5, dtype=x.dtype)))
    meat = jnp.dot(gradients.T, gradients, precision="highest")
    used = jnp.sum(weights > 0, dtype=x.dtype)
    covariance = bread @ meat @ bread * (used / jnp.maximum(used - 5, 1))
    units = jnp.ones(5, x.dtype).at[2].set(to_given.scale)
    return jnp.asarray(to_given.points(centre)), covariance * units[:, None] * units[None, :]
