"""The L2E objective of the mirror plane: values, closed-form gradients, and the log form that is solved.

One plane at a time: v of shape (3,), ω a scalar. Batches come from `jax.vmap`.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.geometry.arrays import AnyArray
from symjax.l2e.jax_config import float64_as_given

Vector = Float[AnyArray, " 3"]
Scalar = Float[Array, ""]
Real = float | Scalar
PairEnds = Float[AnyArray, "n 3"]

_MAX_EXPONENT = 80.0  # exp of it is finite in float32


def _along(points: PairEnds, v: Vector) -> Float[AnyArray, " n"]:
    """Products v · p_i by elementwise products: a float32 matrix product would run in TF32 on a GPU."""
    return points[:, 0] * v[0] + points[:, 1] * v[1] + points[:, 2] * v[2]


def squared_residuals(v: Vector, omega: Real, x: PairEnds, y: PairEnds) -> Float[AnyArray, " n"]:
    """f_i = ‖r_i‖² on the sphere, in the form without cancellation: 4[(m_i·v − ω)² + ‖h_i − (h_i·v)v‖²].

    m_i = (x_i + y_i)/2 and h_i = (y_i − x_i)/2. Equal to the paper's polynomial where ‖v‖ = 1; off the sphere
    the two differ, so compare their projected gradients only.
    """
    m, h = 0.5 * (x + y), 0.5 * (y - x)
    along = _along(h, v)
    across = [h[:, k] - along * v[k] for k in range(3)]
    return 4 * ((_along(m, v) - omega) ** 2 + across[0] ** 2 + across[1] ** 2 + across[2] ** 2)


@float64_as_given
def l2e_weights(v: Vector, omega: Real, sigma: Real, x: PairEnds, y: PairEnds) -> Float[Array, " n"]:
    """exp(−f_i/2σ²): 1 for a pair that the plane mirrors exactly, 0 for an outlier."""
    return jnp.exp(-squared_residuals(v, omega, x, y) / (2 * sigma**2))


@float64_as_given
def l2e_objective(v: Vector, omega: Real, sigma: Real, x: PairEnds, y: PairEnds) -> Scalar:
    """f(v, ω) of Eq. 5, to be maximised: 2/(n(2πσ²)^{3/2}) Σ exp(−f_i/2σ²)."""
    return 2 * jnp.mean(l2e_weights(v, omega, sigma, x, y)) / (2 * math.pi * sigma**2) ** 1.5


@float64_as_given
def l2e_gradients(v: Vector, omega: Real, sigma: Real, x: PairEnds, y: PairEnds) -> tuple[Vector, Scalar]:
    """The closed forms of the paper: (∇_v f, ∂f/∂ω) of the `l2e_objective`, as sums over the pairs.

    ∇_v f is Euclidean, of the polynomial f_i; its projection onto the tangent plane at v is the Riemannian
    gradient of either form. The paper's 3n × n block matrices hold the same sum in O(n²) memory.
    """
    weights = l2e_weights(v, omega, sigma, x, y)
    scale = len(x) * sigma**2 * (2 * math.pi * sigma**2) ** 1.5
    # (C_i + C_iᵀ)v = (y_i·v)x_i + (x_i·v)y_i, and 2m_i = x_i + y_i
    to_x, to_y = omega - _along(y, v), omega - _along(x, v)
    grad_v = jnp.sum((weights * to_x)[:, None] * x + (weights * to_y)[:, None] * y, axis=0)
    grad_omega = jnp.sum(weights * (_along(x + y, v) - 2 * omega))
    return 4 * grad_v / scale, 4 * grad_omega / scale


@float64_as_given
def l2e_loss(
    v: Vector,
    omega: Real,
    sigma: Real,
    x: PairEnds,
    y: PairEnds,
    *,
    weights: Float[Array, " n"] | None = None,
) -> Scalar:
    """The L2E criterion, to be minimised: ∫g² − (2/n) Σ g(r_i) = (4πσ²)^{-3/2} − (2/n) Σ g(r_i) (Eq. 4).

    g is the isotropic normal density of standard deviation σ. The paper prints (2πσ²)^{-3/2} for the first
    term, 2.83 times too large; that moves no plane at a fixed σ, but losses across σ compare only with this.

    Args:
        v: unit normal of the plane.
        omega: offset of the plane.
        sigma: standard deviation σ of the residual, in the units of the points.
        x: one end of every pair.
        y: the other end.
        weights: nonnegative weights of the pairs; the mean is then Σ w_i g(r_i)/Σ w_i.

    Returns:
        The loss, in units of length⁻³.
    """
    kernel = l2e_weights(v, omega, sigma, x, y)
    if weights is None:
        share = jnp.mean(kernel)
    else:
        share = jnp.sum(weights * kernel) / jnp.sum(weights)
    return (4 * math.pi * sigma**2) ** -1.5 - 2 * share / (2 * math.pi * sigma**2) ** 1.5


def log_objective(
    v: Vector,
    omega: Real,
    sigma: Real,
    x: PairEnds,
    y: PairEnds,
    *,
    weights: Float[Array, " n"] | None = None,
) -> Scalar:
    """The logarithm log Σ w_i exp(−f_i/2σ²), to be maximised.

    It has the optimum of `l2e_objective` without its underflow: in float64 every weight is exactly 0 beyond
    37.6σ (13.2σ in float32), where the gradient of Eq. 5 vanishes and a gradient test passes falsely; the
    logarithm keeps its slope everywhere.
    """
    exponents = -squared_residuals(v, omega, x, y) / (2 * sigma**2)
    if weights is None:
        weights = jnp.ones_like(exponents)
    largest = jax.lax.stop_gradient(jnp.max(jnp.where(weights > 0, exponents, -jnp.inf)))
    # only a pair of weight 0 can exceed the largest: it must not overflow to inf · 0
    return largest + jnp.log(jnp.sum(weights * jnp.exp(jnp.minimum(exponents - largest, _MAX_EXPONENT))))


def scaled_log_loss(
    v: Vector,
    omega: Real,
    sigma: Real,
    x: PairEnds,
    y: PairEnds,
    *,
    weights: Float[Array, " n"] | None = None,
) -> Scalar:
    """ψ = σ²(1 − log mean exp(−f_i/2σ²)), to be minimised: what the solvers see.

    On pairs scaled to unit radius its gradient and Hessian are of order one whatever σ is, so that one
    tolerance and one first step serve every σ. The 1 keeps ψ ≥ σ², and so its relative rounding honest: a line
    search that took the rounding of ψ from |ψ| was misled wherever ψ passed through zero.
    """
    total = len(x) if weights is None else jnp.sum(weights)
    return sigma**2 * (1 + jnp.log(total) - log_objective(v, omega, sigma, x, y, weights=weights))
