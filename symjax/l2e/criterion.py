"""The criterion that the solvers minimise: ψ on S² × R at one scale σ, with its derivatives, by matrix products."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from symjax.l2e.features import COLUMNS, PRODUCT_INDEX, ROWS, TWICE, Features, weighted_sums
from symjax.l2e.manifolds import tangent_basis

_CONSTANT = 9  # the feature that is 1
_PLACE = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]], np.int32)  # where a matrix has its entries among the features

Point = Float[Array, " 4"]
"""A plane as a point (v, ω) of S² × R."""


class Expansion(NamedTuple):
    """ψ to second order about a plane.

    Attributes:
        point: the plane (v, ω).
        value: ψ.
        gradient: its derivative in the tangent chart t ↦ (retract(v, B t), ω + t₃), B = `tangent_basis(v)`.
        hessian: its second derivative there.
        scatter: weighted mean of mmᵀ − hhᵀ, less that of m times itself; the weights are exp(−f_i/2σ²).
        middle: weighted mean of m.
        rest: what follows v and ω in the point of an MM step; nothing here.
    """

    point: Float[Array, " d"]
    value: Float[Array, ""]
    gradient: Float[Array, " k"]
    hessian: Float[Array, "k k"]
    scatter: Float[Array, "3 3"]
    middle: Float[Array, " 3"]
    rest: Float[Array, " r"]


class Criterion(NamedTuple):
    """ψ(v, ω) = σ²(1 − log mean exp(−f_i/2σ²)), to be minimised: `objective.scaled_log_loss` of given pairs.

    Attributes:
        pairs: the pairs; constants: nothing is differentiated with respect to them.
        sigma: scale σ, in units of the pairs' radius.
    """

    pairs: Features
    sigma: Float[Array, ""]

    def _psi(self, log_kernel: Float[Array, ""]) -> Float[Array, ""]:
        return self.sigma**2 * (1 + jnp.log(jnp.sum(self.pairs.weights)) - log_kernel)

    def value(self, point: Point) -> Float[Array, ""]:
        """ψ, differentiable in the point: value and gradient cost little more than the exponentials."""

        def sums(point: Point, rows: Float[Array, "t r p"]) -> tuple[Float[Array, ""], Float[Array, " r"]]:
            return weighted_sums(self.pairs, point[:3], point[3], self.sigma, lambda tile: rows[tile])

        @jax.custom_jvp
        def at(point: Point) -> Float[Array, ""]:
            largest, kernel = sums(point, self.pairs.weights[:, None, :])
            return self._psi(largest + jnp.log(kernel[0]))

        @at.defjvp
        def at_jvp(primals: tuple[Point], tangents: tuple[Point]) -> tuple[Float[Array, ""], Float[Array, ""]]:
            point = primals[0]
            largest, means = sums(point, self.pairs.weighted)
            kernel = means[_CONSTANT]
            slope = 2 * jnp.append(*_mean_slopes(point[:3], point[3], means[:_CONSTANT] / kernel))
            return self._psi(largest + jnp.log(kernel)), jnp.sum(slope * tangents[0])

        return at(point)

    def expand(self, point: Point) -> Expansion:
        """ψ, its Riemannian gradient and its exact Hessian in one pass over the pairs."""
        v, omega = point[:3], point[3]
        largest, sums = weighted_sums(self.pairs, v, omega, self.sigma, lambda tile: self.pairs.products[tile])
        kernel = sums[PRODUCT_INDEX[_CONSTANT, _CONSTANT]]
        second = sums[PRODUCT_INDEX] / kernel
        mean = second[_CONSTANT]
        M, m = mean[_PLACE], -0.5 * mean[6:9]
        # to second order along the two tangents and ω
        along = jnp.concatenate([tangent_basis(v).T, jnp.zeros((1, 3), v.dtype)])
        to_omega = jnp.asarray([0, 0, 1], v.dtype)
        from_v, from_omega = _mean_slopes(v, omega, mean)
        slope = _times(along, from_v) + from_omega * to_omega
        shift = 2 * _times(along, m)
        turned = jnp.stack([_times(along, row) for row in M])
        bend = 2 * jnp.stack([_times(turned.T, row) for row in along])
        bend -= jnp.sum(v * from_v) * np.diag([1, 1, 0]).astype(v.dtype)  # the sphere's own curvature
        bend += to_omega[:, None] * (2 * to_omega - shift)[None, :] - shift[:, None] * to_omega[None, :]
        J = _slopes(v, omega, along, to_omega)
        variance = jnp.dot(jnp.dot(J, second, precision="highest"), J.T, precision="highest")
        hessian = 2 * bend - 4 / self.sigma**2 * (variance - slope[:, None] * slope[None, :])
        value = self._psi(largest + jnp.log(kernel))
        return Expansion(point, value, 2 * slope, hessian, M - m[:, None] * m[None, :], m, point[4:])


def reweighted(at: Expansion, values: Float[Array, " 3"], vectors: Float[Array, "3 3"]) -> Float[Array, " d"]:
    """The next point of the MM iteration: the least-squares plane under the weights exp(−f_i/2σ²).

    exp(−t) is convex and lies above its tangent: the surrogate, whose optimum this is, never exceeds the objective,
    so that no step lowers it (half-quadratic optimisation, iteratively reweighted least squares).

    Args:
        at: the expansion about the last point.
        values: eigenvalues of its scatter.
        vectors: their eigenvectors, in columns.
    """
    v = jnp.take(vectors, jnp.argmin(values), axis=1)
    v = v * jnp.where(jnp.sum(v * at.point[:3]) < 0, -1, 1)
    return jnp.concatenate([v, jnp.sum(v * at.middle)[None], at.rest])


def _mean_slopes(
    v: Float[Array, " 3"], omega: Float[Array, ""], mean: Float[Array, " k"]
) -> tuple[Float[Array, " 3"], Float[Array, ""]]:
    """Derivatives of E[f]/4 = vᵀMv − 2ω v·m + ω² + E‖h‖², at fixed weights, in v and ω; `mean` is that of φ."""
    m = -0.5 * mean[6:9]
    return 2 * (_times(mean[_PLACE], v) - omega * m), 2 * (omega - jnp.sum(v * m))


def _times(matrix: Float[Array, "r 3"], u: Float[Array, " 3"]) -> Float[Array, " r"]:
    return matrix[:, 0] * u[0] + matrix[:, 1] * u[1] + matrix[:, 2] * u[2]


def _slopes(
    v: Float[Array, " 3"], omega: Float[Array, ""], along: Float[Array, "3 3"], to_omega: Float[Array, " 3"]
) -> Float[Array, "3 10"]:
    """Derivatives of θ along the two tangents and ω."""
    twice = TWICE.astype(v.dtype)[None, :]
    square = (v[None, ROWS] * along[:, COLUMNS] + along[:, ROWS] * v[None, COLUMNS]) * twice
    mixed = omega * along + to_omega[:, None] * v[None, :]
    return jnp.concatenate([square, mixed, (2 * omega * to_omega)[:, None]], axis=1)
