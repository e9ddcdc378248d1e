"""From a minimum on normalized pairs to a fit in the units of the points, with its derivatives."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.geometry.plane import Plane
from symjax.l2e.features import coefficients, feature_rows
from symjax.l2e.fit import Fit
from symjax.l2e.implicit import implicit_minimum
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.objective import scaled_log_loss
from symjax.l2e.pairs.normalized import NormalizedPairs
from symjax.l2e.solvers.base import Minimum
from symjax.l2e.status import Status

FRACTION = 2**1.5
"""ρ̂ over the mean weight: that of an inlier is E exp(−‖r‖²/2σ²) = 2^{−3/2}, that of an outlier almost 0."""


def psi(z: Float[Array, "4"], theta: tuple[Array, Array, Array, Array]) -> Float[Array, ""]:
    """`scaled_log_loss` as a function of the plane and of everything that an answer has a derivative in.

    In float64 by one matrix product, plain JAX: many times faster under `vmap` than the residuals as written, which
    float32 needs for its digits.
    """
    x, y, weights, sigma = theta
    if x.dtype != jnp.float64:
        return scaled_log_loss(z[:3], z[3], sigma, x, y, weights=weights)
    exponents = jnp.dot(-2 / sigma**2 * coefficients(z[:3], z[3]), feature_rows(x, y), precision="highest")
    exponents = jnp.where(weights > 0, exponents, -jnp.inf)
    largest = jax.lax.stop_gradient(jnp.max(exponents))
    kernel = jnp.dot(jnp.exp(exponents - largest), weights, precision="highest")
    return sigma**2 * (1 + jnp.log(jnp.sum(weights)) - largest - jnp.log(kernel))


def unscale_plane(point: Float[Array, "d"], pairs: NormalizedPairs) -> Plane:
    """A plane (v, ω) of the normalized pairs as one in the units of the points, of canonical sign."""
    return pairs.to_given.plane(Plane(point[:3], point[3])).canonical()


def unscale(pairs: NormalizedPairs, sigma: Float[Array, ""], minimum: Minimum, start: Float[Array, "4"] | None) -> Fit:
    """The fit at a given scale, differentiable in the pairs and in σ.

    Args:
        pairs: the normalized pairs.
        sigma: scale σ in their units.
        minimum: what the solver found.
        start: the plane that it began with, where there is one.
    """
    x, y, weights, to_given = pairs
    z, value = implicit_minimum(psi, SPHERE_LINE, minimum.point, minimum.value, (x, y, weights, sigma))
    log_share = 1 - value / sigma**2
    share = jnp.exp(log_share)
    loss = (4 * math.pi * sigma**2) ** -1.5 - 2 * share / (2 * math.pi * sigma**2) ** 1.5
    # all weights underflow where their sum does, but for a factor that is at most their number
    tiny = jnp.log(jnp.finfo(x.dtype).tiny)
    flat = log_share + jnp.log(jnp.sum(weights)) < tiny
    return Fit(
        plane=unscale_plane(z, pairs),
        loss=loss / to_given.scale**3,
        status=jnp.where(flat, jnp.int32(Status.FLAT), minimum.status),
        num_steps=minimum.num_steps,
        grad_norm=minimum.grad_norm,
        sigma=sigma * to_given.scale,
        inlier_fraction=jnp.minimum(FRACTION * share, 1),
        sigma_estimated=jnp.asarray(False),
        start=None if start is None else unscale_plane(start, pairs),
    )
