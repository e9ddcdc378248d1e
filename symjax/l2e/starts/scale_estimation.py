"""Estimates the scale σ and the inlier fraction ρ together with the plane.

L2E with a partial density (Scott, "Partial mixture estimation and outlier detection in data and regression", 2004)
minimises ρ²(4πσ²)^{−3/2} − (2ρ/n) Σ g(r_i) over the plane, σ and ρ. The best ρ is 2^{3/2} mean exp(−f_i/2σ²). Inserting
it leaves the profile criterion −log mean exp(−f_i/2σ²) + (3/2)s, to be minimised over the plane and s = log σ.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.l2e.criterion import Expansion
from symjax.l2e.fit import WEIGHT_TO_INLIER_FRACTION, Fit, unscale_plane
from symjax.l2e.implicit import implicit_minimum
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.objective import log_objective, squared_residuals
from symjax.l2e.pairs.normalised import NormalisedPairs, systematic_sample
from symjax.l2e.solvers.base import Limits, Minimum, solve
from symjax.l2e.solvers.newton import newton
from symjax.l2e.starts.hypotheses import Hypotheses, rank_hypotheses
from symjax.l2e.status import Status

SIGMA_GRID = (0.5, 0.25, 0.12, 0.06, 0.03, 0.015, 0.007)
"""Scales that the search starts from, in radii."""

PLANES_PER_SIGMA = 4
"""Number of planes that the search starts from at every scale."""

NUM_SAMPLED = 1024
"""Number of pairs sampled for the search. The final solve uses all pairs."""

MIN_SUPPORT = 20
"""Smallest number of inliers ρn at a valid optimum: a plane has three parameters and fits any one pair with σ = 0."""

Data = tuple[Float[Array, "n 3"], Float[Array, "n 3"], Float[Array, " n"]]


def least_sigma(dtype: np.dtype) -> float:
    """Returns the length, in radii, whose square is added to every f_i. For exact pairs f_i has no scale."""
    root: float = float(np.finfo(dtype).eps) ** 0.5
    return 4 * root


def profile(z: Float[Array, " 5"], data: Data) -> Float[Array, ""]:
    """Computes the profile criterion −log mean exp(−f_i/2σ²) + (3/2) log σ at z = (v, ω, log σ)."""
    x, y, weights = data
    sigma = jnp.exp(z[4])
    floor = least_sigma(x.dtype) ** 2 / (2 * sigma**2)
    log_kernel = log_objective(z[:3], z[3], sigma, x, y, weights=weights)
    return jnp.log(jnp.sum(weights)) - log_kernel + floor + 1.5 * z[4]


def expand(z: Float[Array, " 5"], data: Data, unit: Float[Array, ""]) -> Expansion:
    """Expands unit² · `profile` to second order. The MM step is the least-squares plane with σ² = Σ p f/1.5."""
    x, y, weights = data
    basis = SPHERE_LINE.basis(z)

    def chart(t: Float[Array, " 4"]) -> Float[Array, ""]:
        return unit**2 * profile(SPHERE_LINE.retract(z, jnp.sum(basis * t[None, :], axis=1)), data)

    origin = jnp.zeros(4, z.dtype)
    value, gradient = jax.value_and_grad(chart)(origin)
    square = squared_residuals(z[:3], z[3], x, y)
    exponents = jnp.where(weights > 0, -square / (2 * jnp.exp(2 * z[4])), -jnp.inf)
    p = weights * jnp.exp(exponents - jnp.max(exponents))
    p = p / jnp.sum(p)
    m, h = 0.5 * (x + y), 0.5 * (y - x)
    M = jnp.dot((p[:, None] * m).T, m, precision="highest") - jnp.dot((p[:, None] * h).T, h, precision="highest")
    mean_midpoint = jnp.sum(p[:, None] * m, axis=0)
    log_sigma = 0.5 * jnp.log((jnp.sum(p * square) + least_sigma(x.dtype) ** 2) / 1.5)
    scatter = M - mean_midpoint[:, None] * mean_midpoint[None, :]
    return Expansion(z, value, gradient, jax.hessian(chart)(origin), scatter, mean_midpoint, log_sigma[None])


def _solve(start: Float[Array, " 5"], data: Data, limits: Limits) -> Minimum:
    unit = jnp.exp(start[4])
    minimum: Minimum = solve(newton(lambda z: expand(z, data, unit), **limits._asdict()), start)
    return minimum._replace(value=minimum.value / unit**2)


def starts_at_all_scales(proposed: Hypotheses, pairs: NormalisedPairs) -> Float[Array, "k 5"]:
    """Returns the best distinct hypotheses at every scale of the grid, as points (v, ω, log σ)."""
    grid = jnp.asarray(SIGMA_GRID, pairs.x.dtype)
    planes = jax.vmap(lambda sigma: rank_hypotheses(proposed, pairs, sigma, num=PLANES_PER_SIGMA))(grid)
    scales = jnp.broadcast_to(jnp.log(grid)[:, None, None], (len(SIGMA_GRID), PLANES_PER_SIGMA, 1))
    return jnp.concatenate([planes, scales], axis=2).reshape(-1, 5)


def estimate_scale(
    starts: Float[Array, "k 5"], pairs: NormalisedPairs, limits: Limits
) -> tuple[Minimum, Float[Array, " 5"]]:
    """Minimises from several starts. Returns the best minimum supported by enough pairs, and its start."""
    x, y, weights, _ = jax.lax.stop_gradient(pairs)
    row = systematic_sample(weights, NUM_SAMPLED)
    sample = x[row], y[row], jnp.ones_like(weights[row])
    found = jax.vmap(lambda start: _solve(start, sample, limits))(starts)
    rho = WEIGHT_TO_INLIER_FRACTION * jnp.exp(1.5 * found.point[:, 4] - found.value)
    supported = rho * jnp.minimum(jnp.sum(weights > 0, dtype=weights.dtype), NUM_SAMPLED) >= MIN_SUPPORT
    value = jnp.where(jnp.isfinite(found.value), found.value, jnp.inf)
    # if too few pairs support each of them, the one with the most support
    best = jnp.where(jnp.any(supported), jnp.argmin(jnp.where(supported, value, jnp.inf)), jnp.argmax(rho))
    return _solve(found.point[best], (x, y, weights), limits), starts[best]


def unscale_with_sigma(pairs: NormalisedPairs, minimum: Minimum, start: Float[Array, " 5"]) -> Fit:
    """Converts a minimum with its estimated scale to a fit in the units of the points, differentiable in the pairs."""
    x, y, weights, to_given = pairs
    z, value = implicit_minimum(profile, SPHERE_LINE, minimum.point, minimum.value, (x, y, weights))
    sigma = jnp.exp(z[4])
    mean_weight = jnp.exp(1.5 * z[4] - value)
    loss = -((mean_weight / (2 * math.pi * sigma**2) ** 1.5) ** 2) * (4 * math.pi * sigma**2) ** 1.5
    support = WEIGHT_TO_INLIER_FRACTION * mean_weight * jnp.sum(weights > 0, dtype=weights.dtype)
    unsupported = (minimum.status == Status.SUCCESSFUL.value) & (support < MIN_SUPPORT)
    return Fit(
        plane=unscale_plane(z, pairs),
        loss=loss / to_given.scale**3,
        status=jnp.where(unsupported, jnp.int32(Status.UNSUPPORTED), minimum.status),
        num_steps=minimum.num_steps,
        grad_norm=minimum.grad_norm,
        sigma=sigma * to_given.scale,
        inlier_fraction=jnp.minimum(WEIGHT_TO_INLIER_FRACTION * mean_weight, 1),
        sigma_estimated=jnp.asarray(True),
        start=unscale_plane(start, pairs),
    )
