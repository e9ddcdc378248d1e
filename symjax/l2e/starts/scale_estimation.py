"""The scale σ and the share ρ of mirror pairs, estimated with the plane.

L2E with a partial density (Scott, "Partial mixture estimation and outlier detection in data and regression", 2004):
minimise ρ²(4πσ²)^{−3/2} − (2ρ/n) Σ g(r_i) over the plane, σ and ρ. The best ρ is 2^{3/2} mean exp(−f_i/2σ²); with it
put in, what is left to minimise over the plane and s = log σ is −log mean exp(−f_i/2σ²) + (3/2)s.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.l2e.criterion import Expansion
from symjax.l2e.fit import FRACTION, Fit, unscale_plane
from symjax.l2e.implicit import implicit_minimum
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.objective import log_objective, squared_residuals
from symjax.l2e.pairs.normalised import NormalisedPairs, systematic_sample
from symjax.l2e.solvers.base import Limits, Minimum, solve
from symjax.l2e.solvers.newton import newton
from symjax.l2e.starts.hypotheses import Hypotheses, rank_hypotheses
from symjax.l2e.status import Status

GRID = (0.5, 0.25, 0.12, 0.06, 0.03, 0.015, 0.007)
"""Scales that the search begins with, in radii."""

PER_SCALE = 4
"""Planes that it begins with at each."""

NUM_SAMPLED = 1024
"""Number of pairs sampled for the search; the final solve uses all pairs."""

LEAST_SUPPORT = 20
"""Mirror pairs, ρn, below which an optimum is none: three numbers fit any one pair exactly, at σ = 0."""

Data = tuple[Float[Array, "n 3"], Float[Array, "n 3"], Float[Array, " n"]]


def least_sigma(dtype: jnp.dtype) -> float:
    """What is added in squares to σ, in radii: exact pairs have σ = 0, where the criterion has no minimum."""
    return 4 * float(jnp.finfo(dtype).eps) ** 0.5


def profile(z: Float[Array, " 5"], data: Data) -> Float[Array, ""]:
    """−log mean exp(−f_i/2σ²) + (3/2) log σ at z = (v, ω, log σ)."""
    x, y, weights = data
    sigma = jnp.exp(z[4])
    floor = least_sigma(x.dtype) ** 2 / (2 * sigma**2)
    log_kernel = log_objective(z[:3], z[3], sigma, x, y, weights=weights)
    return jnp.log(jnp.sum(weights)) - log_kernel + floor + 1.5 * z[4]


def expand(z: Float[Array, " 5"], data: Data, unit: Float[Array, ""]) -> Expansion:
    """`profile` times unit² to second order, with the MM step, which is the least-squares plane and σ² = Σ p f/1.5."""
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
    middle = jnp.sum(p[:, None] * m, axis=0)
    scale = 0.5 * jnp.log((jnp.sum(p * square) + least_sigma(x.dtype) ** 2) / 1.5)
    scatter = M - middle[:, None] * middle[None, :]
    return Expansion(z, value, gradient, jax.hessian(chart)(origin), scatter, middle, scale[None])


def _solve(start: Float[Array, " 5"], data: Data, limits: Limits) -> Minimum:
    unit = jnp.exp(start[4])
    minimum = solve(newton(lambda z: expand(z, data, unit), **limits._asdict()), start)
    return minimum._replace(value=minimum.value / unit**2)


def starts_at_all_scales(proposed: Hypotheses, pairs: NormalisedPairs) -> Float[Array, "k 5"]:
    """The best distinct hypotheses at every scale of the grid."""
    grid = jnp.asarray(GRID, pairs.x.dtype)
    planes = jax.vmap(lambda sigma: rank_hypotheses(proposed, pairs, sigma, num=PER_SCALE))(grid)
    scales = jnp.broadcast_to(jnp.log(grid)[:, None, None], (len(GRID), PER_SCALE, 1))
    return jnp.concatenate([planes, scales], axis=2).reshape(-1, 5)


def estimate_scale(
    starts: Float[Array, "k 5"], pairs: NormalisedPairs, limits: Limits
) -> tuple[Minimum, Float[Array, " 5"]]:
    """The best optimum from several starts that enough pairs support, and its start."""
    x, y, weights, _ = jax.lax.stop_gradient(pairs)
    row = systematic_sample(weights, NUM_SAMPLED)
    some = x[row], y[row], jnp.ones_like(weights[row])
    found = jax.vmap(lambda start: _solve(start, some, limits))(starts)
    shares = FRACTION * jnp.exp(1.5 * found.point[:, 4] - found.value)
    supported = shares * jnp.minimum(jnp.sum(weights > 0, dtype=weights.dtype), NUM_SAMPLED) >= LEAST_SUPPORT
    value = jnp.where(jnp.isfinite(found.value), found.value, jnp.inf)
    # where none is supported, the most supported
    best = jnp.where(jnp.any(supported), jnp.argmin(jnp.where(supported, value, jnp.inf)), jnp.argmax(shares))
    return _solve(found.point[best], (x, y, weights), limits), starts[best]


def unscale_with_sigma(pairs: NormalisedPairs, minimum: Minimum, start: Float[Array, " 5"]) -> Fit:
    """The fit at the estimated scale, differentiable in the pairs."""
    x, y, weights, to_given = pairs
    z, value = implicit_minimum(profile, SPHERE_LINE, minimum.point, minimum.value, (x, y, weights))
    sigma = jnp.exp(z[4])
    share = jnp.exp(1.5 * z[4] - value)
    loss = -((share / (2 * math.pi * sigma**2) ** 1.5) ** 2) * (4 * math.pi * sigma**2) ** 1.5
    support = FRACTION * share * jnp.sum(weights > 0, dtype=weights.dtype)
    lacking = (minimum.status == Status.SUCCESSFUL.value) & (support < LEAST_SUPPORT)
    return Fit(
        plane=unscale_plane(z, pairs),
        loss=loss / to_given.scale**3,
        status=jnp.where(lacking, jnp.int32(Status.UNSUPPORTED), minimum.status),
        num_steps=minimum.num_steps,
        grad_norm=minimum.grad_norm,
        sigma=sigma * to_given.scale,
        inlier_fraction=jnp.minimum(FRACTION * share, 1),
        sigma_estimated=jnp.asarray(True),
        start=unscale_plane(start, pairs),
    )
