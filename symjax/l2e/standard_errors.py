"""How sure a fit is: the sandwich covariance of the L2E estimate."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.l2e.fit import FRACTION, Fit
from symjax.l2e.jax_config import float64_as_given
from symjax.l2e.manifolds import SPHERE_LINE, tangent_basis
from symjax.l2e.objective import squared_residuals
from symjax.l2e.pairs.arguments import Points, Weights
from symjax.l2e.pairs.normalised import normalise_pairs
from symjax.l2e.pairs.padded import PaddedPairs, pad_pairs


class StandardErrors(NamedTuple):
    """Standard errors of a fit.

    Attributes:
        plane: covariance of the plane, with its regions.
        sigma: standard error of σ̂, in the units of the points; 0 where σ was given.
        inlier_fraction: standard error of ρ̂.
    """

    plane: Uncertainty
    sigma: float
    inlier_fraction: float


@float64_as_given
def standard_errors(
    fit: Fit,
    x: Points,
    y: Points,
    *,
    weights: Weights | None = None,
) -> StandardErrors:
    """Standard errors of a fit by the sandwich formula A⁻¹BA⁻¹ of M-estimators (Godambe).

    A is the Hessian of the partial-density criterion and B the sum of the outer products of the pairs' gradients, in
    the tangent chart of the plane, log σ (where it was estimated) and ρ. Pairs are taken to be independent: the errors
    are too small where neighbouring pairs share theirs, or where a pair is listed twice, from either end.

    Args:
        fit: one fit, of `fit_plane` or `fit_global`.
        x: one end of every pair that it was fitted to.
        y: the other end.
        weights: weights of the pairs.

    Raises:
        InvalidArgumentError: for several fits at once.
        SymjaxError: see `fit_plane`.
    """
    if shape := np.shape(fit.loss):
        raise InvalidArgumentError(f"these are fits of shape {shape}: standard errors are of one fit at a time")
    pairs = pad_pairs(x, y, weights)
    centre, covariance = (np.asarray(part, float) for part in _sandwich(fit, pairs))
    tangents = np.asarray(tangent_basis(jnp.asarray(fit.plane.normal))).T
    variances = np.diag(covariance)
    plane = Uncertainty(covariance[:3, :3], tangents, centre)
    return StandardErrors(plane, float(fit.sigma) * float(np.sqrt(variances[3])), float(np.sqrt(variances[4])))


@jax.jit
def _sandwich(fit: Fit, pairs: PaddedPairs) -> tuple[Float[Array, " 3"], Float[Array, "5 5"]]:
    """Middle of the mirror pairs, and covariance of (two turns, distance there, log σ, ρ)."""
    x, y, weights, to_given = normalise_pairs(pairs.x, pairs.y, pairs.weights)
    normal, offset, sigma = (jnp.asarray(part, x.dtype) for part in (*fit.plane, fit.sigma))
    v, omega = (jnp.asarray(part) for part in to_given.inverse().plane(Plane(normal, offset)))
    sigma = sigma / to_given.scale
    kernel = weights * jnp.exp(-squared_residuals(v, omega, x, y) / (2 * sigma**2))
    # not cut to 1, as `Fit.inlier_fraction` is: it is where the criterion is stationary
    share = FRACTION * jnp.sum(kernel) / jnp.sum(weights)
    point = jnp.concatenate([v, jnp.stack([omega, jnp.log(sigma), share])])
    middle = jnp.sum(kernel[:, None] * 0.5 * (x + y), axis=0) / jnp.sum(kernel)

    def terms(t: Float[Array, " 5"]) -> Float[Array, " n"]:
        """Every pair's term of ρ²(4πσ²)^{−3/2} − 2ρ g(r), over the constant (2πσ̂²)^{−3/2}."""
        basis = SPHERE_LINE.basis(point)
        moved = SPHERE_LINE.retract(point, jnp.sum(basis * t[None, :], axis=1))
        # the turn is about the middle of the mirror pairs, where the distance is least correlated with it
        offset = jnp.sum((moved[:3] - v) * middle) + moved[3]
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
    return jnp.asarray(to_given.points(middle)), covariance * units[:, None] * units[None, :]
