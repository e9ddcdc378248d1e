"""The L2E objective of the mirror plane: its value, its closed-form gradients, and the log form that is minimised.

Every function takes one plane, v of shape (3,) and a scalar ω. Use `jax.vmap` for a batch. Functions decorated by
`keep_float64` return NumPy arrays if the pairs are float64 and JAX's x64 flag is off.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax.geometry.arrays import AnyArray
from symjax.l2e.jax_config import keep_float64

Vector = Float[AnyArray, " 3"]
Scalar = Float[Array, ""]
AnyScalar = Float[AnyArray, ""]
Real = float | Scalar
PairEnds = Float[AnyArray, "n 3"]

_MAX_EXPONENT = 80.0  # exp of it is finite in float32


def _along(points: PairEnds, v: Vector) -> Float[AnyArray, " n"]:
    """Computes v · p_i elementwise, because a float32 matrix product would run in TF32 on a GPU."""
    return points[:, 0] * v[0] + points[:, 1] * v[1] + points[:, 2] * v[2]


def squared_residuals(v: Vector, omega: Real, x: PairEnds, y: PairEnds) -> Float[AnyArray, " n"]:
    """Computes f_i = ‖r_i‖² for a unit v in the form without cancellation, 4[(m_i·v − ω)² + ‖h_i − (h_i·v)v‖²].

    Here m_i = (x_i + y_i)/2 and h_i = (y_i − x_i)/2. The form equals the paper's polynomial where ‖v‖ = 1. Off the
    sphere the two differ, so compare only their projected gradients.
    """
    m, h = 0.5 * (x + y), 0.5 * (y - x)
    along = _along(h, v)
    across = [h[:, k] - along * v[k] for k in range(3)]
    return 4 * ((_along(m, v) - omega) ** 2 + across[0] ** 2 + across[1] ** 2 + across[2] ** 2)


@keep_float64
def l2e_weights(v: Vector, omega: Real, sigma: Real, x: PairEnds, y: PairEnds) -> Float[AnyArray, " n"]:
    """Computes the weights exp(−f_i/2σ²): 1 for an exact mirror pair of the plane, nearly 0 for an outlier."""
    return jnp.exp(-squared_residuals(v, omega, x, y) / (2 * sigma**2))


@keep_float64
def l2e_objective(v: Vector, omega: Real, sigma: Real, x: PairEnds, y: PairEnds) -> AnyScalar:
    """Computes f(v, ω) of Eq. 5, to be maximised: 2/(n(2πσ²)^{3/2}) Σ exp(−f_i/2σ²)."""
    return 2 * jnp.mean(l2e_weights(v, omega, sigma, x, y)) / (2 * math.pi * sigma**2) ** 1.5


@keep_float64
def l2e_gradients(v: Vector, omega: Real, sigma: Real, x: PairEnds, y: PairEnds) -> tuple[Vector, AnyScalar]:
    """Computes (∇_v f, ∂f/∂ω) of the `l2e_objective` by the paper's closed forms, as sums over the pairs.

    ∇_v f is the Euclidean gradient, with f_i as the paper's polynomial. Its projection onto the tangent plane at v is
    the Riemannian gradient, which is the same for both forms of f_i. The paper's 3n × n block matrices hold the same
    sum in O(n²) memory.
    """
    weights = l2e_weights(v, omega, sigma, x, y)
    scale = len(x) * sigma**2 * (2 * math.pi * sigma**2) ** 1.5
    # (C_i + C_iᵀ)v = (y_i·v)x_i + (x_i·v)y_i, and 2m_i = x_i + y_i
    to_x, to_y = omega - _along(y, v), omega - _along(x, v)
    grad_v = jnp.sum((weights * to_x)[:, None] * x + (weights * to_y)[:, None] * y, axis=0)
    grad_omega = jnp.sum(weights * (_along(x + y, v) - 2 * omega))
    return 4 * grad_v / scale, 4 * grad_omega / scale


@keep_float64
def l2e_loss(
    v: Vector,
    omega: Real,
    sigma: Real,
    x: PairEnds,
    y: PairEnds,
    *,
    weights: Float[Array, " n"] | None = None,
) -> AnyScalar:
    """Computes the L2E criterion, to be minimised: ∫g² − (2/n) Σ g(r_i) = (4πσ²)^{-3/2} − (2/n) Σ g(r_i) (Eq. 4).

    g is the isotropic normal density of standard deviation σ. The paper prints (2πσ²)^{-3/2} for the first term,
    which is 2.83 times too large. At a fixed σ this does not change the best plane, but losses at different σ are
    comparable only with the correct term.

    Args:
        v: unit normal of the plane.
        omega: offset of the plane, in the units of the points.
        sigma: scale σ, the standard deviation of the residual, in the units of the points.
        x: one end of every pair, in any unit.
        y: the other end, in the same unit.
        weights: nonnegative weights of the pairs. The mean of g is then Σ w_i g(r_i)/Σ w_i.

    Returns:
        The loss, in the units of the points to the power −3. It is a JAX array; or a NumPy array, in float64, if `x` or
        `y` is float64 while JAX's x64 flag is off, as it is by default.

    Example:
        Exact mirror pairs of the plane z = 0 have the lowest loss there:

        >>> import numpy as np, symjax
        >>> x = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 2.0]])
        >>> y = x * [1, 1, -1]
        >>> for omega in (0.0, 0.5):
        ...     loss = symjax.l2e_loss(np.array([0.0, 0.0, 1.0]), omega, 1.0, x, y)
        ...     print(f"{loss:.4f}")
        -0.1045
        -0.0546
    """
    kernel = l2e_weights(v, omega, sigma, x, y)
    if weights is None:
        mean_kernel = jnp.mean(kernel)
    else:
        mean_kernel = jnp.sum(weights * kernel) / jnp.sum(weights)
    return (4 * math.pi * sigma**2) ** -1.5 - 2 * mean_kernel / (2 * math.pi * sigma**2) ** 1.5


def log_objective(
    v: Vector,
    omega: Real,
    sigma: Real,
    x: PairEnds,
    y: PairEnds,
    *,
    weights: Float[Array, " n"] | None = None,
) -> Scalar:
    """Computes log Σ w_i exp(−f_i/2σ²), to be maximised.

    It has the same optimum as `l2e_objective` but does not underflow. In float64 every weight is exactly 0 beyond
    37.6σ (13.2σ in float32). There the gradient of Eq. 5 vanishes, and a convergence test on it passes falsely. The
    logarithm has a nonzero gradient there.
    """
    exponents = -squared_residuals(v, omega, x, y) / (2 * sigma**2)
    if weights is None:
        weights = jnp.ones_like(exponents)
    largest = jax.lax.stop_gradient(jnp.max(jnp.where(weights > 0, exponents, -jnp.inf)))
    # a pair of weight 0 can exceed the largest; the limit keeps it from overflowing to inf · 0
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
    """Computes ψ = σ²(1 − log mean exp(−f_i/2σ²)), the function that the solvers minimise.

    For pairs scaled to unit radius its gradient and Hessian are of order one at every σ, so one tolerance and one
    first step suit every σ. The term 1 keeps ψ ≥ σ². Without it ψ passes through zero, where a line search that
    estimates the rounding error of ψ from |ψ| goes wrong.
    """
    total = len(x) if weights is None else jnp.sum(weights)
    return sigma**2 * (1 + jnp.log(total) - log_objective(v, omega, sigma, x, y, weights=weights))
