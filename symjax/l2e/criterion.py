"""The criterion that the solvers minimise: ψ on S² × R at one scale σ, and its derivatives, by matrix products."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.l2e.features import COLUMNS, MULTIPLICITY, PRODUCT_INDEX, ROWS, Features, weighted_sums
from symjax.l2e.manifolds import tangent_basis

_CONSTANT = 9  # index of the feature that is 1
_ENTRY_INDEX = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]], np.int32)  # of a symmetric matrix, among the features

Point = Float[Array, " 4"]
"""A plane as a point (v, ω) of S² × R."""


class Expansion(NamedTuple):
    """Second-order expansion of ψ about a plane, and the weighted moments of the pairs there.

    The weights are exp(−f_i/2σ²).

    Attributes:
        point: the plane (v, ω).
        value: ψ.
        gradient: gradient of ψ in the tangent chart t ↦ (retract(v, B t), ω + t₃), where B = `tangent_basis(v)`.
        hessian: Hessian of ψ in that chart.
        scatter: weighted mean of mmᵀ − hhᵀ, minus m̄m̄ᵀ.
        mean_midpoint: weighted mean m̄ of the mid-points m.
        rest: coordinates that follow v and ω in the point of an MM step. Empty at a fixed σ.
    """

    point: Float[Array, " d"]
    value: Float[Array, ""]
    gradient: Float[Array, " k"]
    hessian: Float[Array, "k k"]
    scatter: Float[Array, "3 3"]
    mean_midpoint: Float[Array, " 3"]
    rest: Float[Array, " r"]


class Criterion(NamedTuple):
    """ψ(v, ω) = σ²(1 − log mean exp(−f_i/2σ²)), to be minimised: `objective.scaled_log_loss` for given pairs.

    Attributes:
        pairs: features of the pairs. They are constants: nothing is differentiated with respect to them.
        sigma: scale σ, in units of the pairs' radius.
    """

    pairs: Features
    sigma: Float[Array, ""]

    def _psi(self, log_kernel: Float[Array, ""]) -> Float[Array, ""]:
        return self.sigma**2 * (1 + jnp.log(jnp.sum(self.pairs.weights)) - log_kernel)

    def value(self, point: Point) -> Float[Array, ""]:
        """Computes ψ, differentiable in the point. Value and gradient cost little more than the exponentials."""

        def sums(point: Point, rows: Float[Array, "t r p"]) -> tuple[Float[Array, ""], Float[Array, " r"]]:
            return weighted_sums(self.pairs, point[:3], point[3], self.sigma, lambda tile: rows[tile])

        @jax.custom_jvp
        def psi(point: Point) -> Float[Array, ""]:
            largest, kernel = sums(point, self.pairs.weights[:, None, :])
            return self._psi(largest + jnp.log(kernel[0]))

        @psi.defjvp
        def psi_jvp(primals: tuple[Point], tangents: tuple[Point]) -> tuple[Float[Array, ""], Float[Array, ""]]:
            point = primals[0]
            largest, means = sums(point, self.pairs.weighted)
            kernel = means[_CONSTANT]
            gradient = 2 * jnp.append(*_mean_gradient(point[:3], point[3], means[:_CONSTANT] / kernel))
            return self._psi(largest + jnp.log(kernel)), jnp.sum(gradient * tangents[0])

        return psi(point)

    def expand(self, point: Point) -> Expansion:
        """Computes ψ, its Riemannian gradient and its exact Hessian in one pass over the pairs."""
        v, omega = point[:3], point[3]
        largest, sums = weighted_sums(self.pairs, v, omega, self.sigma, lambda tile: self.pairs.products[tile])
        kernel = sums[PRODUCT_INDEX[_CONSTANT, _CONSTANT]]
        second = sums[PRODUCT_INDEX] / kernel
        mean = second[_CONSTANT]
        M, m = mean[_ENTRY_INDEX], -0.5 * mean[6:9]
        # derivatives of v and ω along the chart's axes, the two tangents and ω
        v_dot = jnp.concatenate([tangent_basis(v).T, jnp.zeros((1, 3), v.dtype)])
        omega_dot = jnp.asarray([0, 0, 1], v.dtype)
        by_v, by_omega = _mean_gradient(v, omega, mean)
        gradient = _matvec(v_dot, by_v) + by_omega * omega_dot
        mixed = 2 * _matvec(v_dot, m)
        M_v_dot = jnp.stack([_matvec(v_dot, row) for row in M])
        mean_hessian = 2 * jnp.stack([_matvec(M_v_dot.T, row) for row in v_dot])
        mean_hessian -= jnp.sum(v * by_v) * np.diag([1, 1, 0]).astype(v.dtype)  # the sphere's own curvature
        mean_hessian += omega_dot[:, None] * (2 * omega_dot - mixed)[None, :] - mixed[:, None] * omega_dot[None, :]
        J = _theta_jacobian(v, omega, v_dot, omega_dot)
        second_moment = jnp.dot(jnp.dot(J, second, precision="highest"), J.T, precision="highest")
        hessian = 2 * mean_hessian - 4 / self.sigma**2 * (second_moment - gradient[:, None] * gradient[None, :])
        value = self._psi(largest + jnp.log(kernel))
        return Expansion(point, value, 2 * gradient, hessian, M - m[:, None] * m[None, :], m, point[4:])


def mm_step(expansion: Expansion, values: Float[Array, " 3"], vectors: Float[Array, "3 3"]) -> Float[Array, " d"]:
    """Returns the next point of the MM iteration: the least-squares plane under the weights exp(−f_i/2σ²).

    exp(−t) is convex, so it lies above its tangent. The surrogate that this plane maximises therefore never exceeds
    the objective, and no step lowers the objective (half-quadratic optimisation, iteratively reweighted least squares).

    Args:
        expansion: the expansion about the current point.
        values: eigenvalues of its scatter.
        vectors: their eigenvectors, in columns.
    """
    v = jnp.take(vectors, jnp.argmin(values), axis=1)
    v = v * jnp.where(jnp.sum(v * expansion.point[:3]) < 0, -1, 1)
    return jnp.concatenate([v, jnp.sum(v * expansion.mean_midpoint)[None], expansion.rest])


def _mean_gradient(
    v: Float[Array, " 3"], omega: Float[Array, ""], mean: Float[Array, " k"]
) -> tuple[Float[Array, " 3"], Float[Array, ""]]:
    """Derivatives of E[f]/4 = vᵀMv − 2ω v·m + ω² + E‖h‖² in v and ω at fixed weights; `mean` is E[φ]."""
    m = -0.5 * mean[6:9]
    return 2 * (_matvec(mean[_ENTRY_INDEX], v) - omega * m), 2 * (omega - jnp.sum(v * m))


def _matvec(matrix: Float[Array, "r 3"], u: Float[Array, " 3"]) -> Float[Array, " r"]:
    return matrix[:, 0] * u[0] + matrix[:, 1] * u[1] + matrix[:, 2] * u[2]


def _theta_jacobian(
    v: Float[Array, " 3"], omega: Float[Array, ""], v_dot: Float[Array, "3 3"], omega_dot: Float[Array, " 3"]
) -> Float[Array, "3 10"]:
    """Derivatives of the coefficients θ along the two tangents and ω."""
    multiplicity = MULTIPLICITY.astype(v.dtype)[None, :]
    square = (v[None, ROWS] * v_dot[:, COLUMNS] + v_dot[:, ROWS] * v[None, COLUMNS]) * multiplicity
    mixed = omega * v_dot + omega_dot[:, None] * v[None, :]
    return jnp.concatenate([square, mixed, (2 * omega * omega_dot)[:, None]], axis=1)
