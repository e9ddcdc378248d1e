"""The criterion that the solvers minimise: ψ on S² × R at one scale σ, with its derivatives, by matrix products."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from symjax import jacobi
from symjax.features import ENTRIES, PRODUCT_INDEX, Features, coefficients, weighted_sums
from symjax.sphere import tangent_basis

_CONSTANT = 9  # the feature that is 1

Point = Float[Array, "4"]
"""A plane as a point (v, ω) of S² × R."""


class Expansion(NamedTuple):
    """ψ to second order about a plane.

    Attributes:
        point: the plane (v, ω).
        value: ψ.
        gradient: its derivative in the tangent chart t ↦ (retract(v, B t), ω + t₃), B = `tangent_basis(v)`.
        hessian: its second derivative there.
        reweighted: the plane of an MM step.
    """

    point: Point
    value: Float[Array, ""]
    gradient: Float[Array, "3"]
    hessian: Float[Array, "3 3"]
    reweighted: Point


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

        def evaluate(point: Point) -> tuple[Float[Array, ""], Float[Array, "11"]]:
            rows = self.pairs.weighted
            largest, sums = weighted_sums(self.pairs, point[:3], point[3], self.sigma, lambda tile: rows[tile])
            return self._psi(largest + jnp.log(sums[_CONSTANT])), sums / sums[_CONSTANT]

        @jax.custom_jvp
        def at(theta: Float[Array, "11"], point: Point) -> Float[Array, ""]:
            del theta  # the coefficients of the point: the derivative goes through them
            return evaluate(point)[0]

        @at.defjvp
        def at_jvp(
            primals: tuple[Float[Array, "11"], Point], tangents: tuple[Float[Array, "11"], Point]
        ) -> tuple[Float[Array, ""], Float[Array, ""]]:
            psi, mean = evaluate(primals[1])
            # dψ = 2 E[φ]·dθ under the weights
            return psi, 2 * jnp.sum(mean * tangents[0])

        return at(coefficients(point[:3], point[3]), point)

    def expand(self, point: Point) -> Expansion:
        """ψ, its Riemannian gradient and its exact Hessian in one pass over the pairs."""
        v, omega = point[:3], point[3]
        largest, sums = weighted_sums(self.pairs, v, omega, self.sigma, lambda tile: self.pairs.products[tile])
        kernel = sums[PRODUCT_INDEX[_CONSTANT, _CONSTANT]]
        second = sums[PRODUCT_INDEX] / kernel
        mean = second[_CONSTANT]
        M, m = _quadratic_form(mean), -0.5 * mean[6:9]
        # E[f]/4 = vᵀMv − 2ω v·m + ω² and a constant
        to_v = 2 * (_times(M, v) - omega * m)
        to_omega = 2 * (omega - jnp.sum(v * m))
        basis = tangent_basis(v)
        b, c = basis[:, 0], basis[:, 1]
        slope = jnp.stack([jnp.sum(b * to_v), jnp.sum(c * to_v), to_omega])
        turn = -jnp.sum(v * to_v)  # the sphere's curvature
        Mb, Mc = _times(M, b), _times(M, c)
        bc, b_omega, c_omega = 2 * jnp.sum(b * Mc), -2 * jnp.sum(b * m), -2 * jnp.sum(c * m)
        bend = _matrix(
            [
                [2 * jnp.sum(b * Mb) + turn, bc, b_omega],
                [bc, 2 * jnp.sum(c * Mc) + turn, c_omega],
                [b_omega, c_omega, jnp.full_like(omega, 2)],
            ]
        )
        J = jnp.stack([_turned(v, omega, b), _turned(v, omega, c), _shifted(v, omega)])
        variance = jnp.dot(jnp.dot(J, second, precision="highest"), J.T, precision="highest")
        variance -= slope[:, None] * slope[None, :]
        value = self._psi(largest + jnp.log(kernel))
        hessian = 2 * bend - 4 / self.sigma**2 * variance
        return Expansion(point, value, 2 * slope, hessian, least_squares(M, m, near=v))


def least_squares(M: Float[Array, "3 3"], m: Float[Array, "3"], *, near: Float[Array, "3"]) -> Point:
    """The least-squares plane under given weights, which is the next plane of the MM iteration.

    exp(−t) is convex and lies above its tangent: the surrogate, whose optimum this is with the weights exp(−f_i/2σ²),
    never exceeds the objective, so that no step lowers it (half-quadratic optimisation, reweighted least squares).

    Args:
        M: weighted mean of mmᵀ − hhᵀ.
        m: weighted mean of the mid-points.
        near: the normal's sign is that of this one.
    """
    values, vectors = jacobi.eigh(M - m[:, None] * m[None, :])
    v = jnp.take(vectors, jnp.argmin(values), axis=1)
    v = v * jnp.where(jnp.sum(v * near) < 0, -1, 1)
    return jnp.append(v, jnp.sum(v * m))


def _quadratic_form(entries: Float[Array, "10"]) -> Float[Array, "3 3"]:
    """The symmetric matrix of which the first six features hold the entries."""
    place = {entry: k for k, entry in enumerate(ENTRIES)}
    return _matrix([[entries[place[min(i, j), max(i, j)]] for j in range(3)] for i in range(3)])


def _times(matrix: Float[Array, "3 3"], u: Float[Array, "3"]) -> Float[Array, "3"]:
    return matrix[:, 0] * u[0] + matrix[:, 1] * u[1] + matrix[:, 2] * u[2]


def _matrix(rows: list[list[Float[Array, ""]]]) -> Float[Array, "r c"]:
    return jnp.stack([jnp.stack(row) for row in rows])


def _turned(v: Float[Array, "3"], omega: Float[Array, ""], b: Float[Array, "3"]) -> Float[Array, "10"]:
    """Derivative of θ as v turns towards b."""
    square = [(v[i] * b[j] + v[j] * b[i]) * (1 if i == j else 2) for i, j in ENTRIES]
    return jnp.stack([*square, omega * b[0], omega * b[1], omega * b[2], jnp.zeros_like(omega)])


def _shifted(v: Float[Array, "3"], omega: Float[Array, ""]) -> Float[Array, "10"]:
    """Derivative of θ in ω."""
    return jnp.concatenate([jnp.zeros_like(v), jnp.zeros_like(v), v, (2 * omega)[None]])
