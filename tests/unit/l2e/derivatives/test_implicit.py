"""The minimiser of vᵀAv is an eigenvector, whose derivatives are known from first-order perturbation theory."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.l2e.implicit import implicit_minimum
from symjax.l2e.manifolds import SPHERE


def rayleigh(v, theta):
    return jnp.sum(v * (theta @ v))


def eigenvector(theta):
    z = jax.lax.stop_gradient(jnp.linalg.eigh(theta)[1][:, 0])
    return implicit_minimum(rayleigh, SPHERE, z, rayleigh(z, theta), theta)[0]


@pytest.fixture
def theta(rng):
    A = rng.normal(size=(2, 3, 3))
    return [jnp.asarray(B + B.T) for B in A]


def perturbation(A, E):
    values, V = np.linalg.eigh(A)
    return sum(V[:, k] * (V[:, k] @ E @ V[:, 0]) / (values[0] - values[k]) for k in (1, 2))


def test_tangent_is_that_of_perturbation_theory(theta):
    A, E = theta
    point, tangent = jax.jvp(eigenvector, (A,), (E,))
    np.testing.assert_array_equal(point, jnp.linalg.eigh(A)[1][:, 0])
    np.testing.assert_allclose(tangent, perturbation(A, E), atol=1e-13)


@pytest.mark.any_precision
def test_reverse_is_the_transpose_of_forward(theta):
    A, E = theta
    forward = jax.jvp(eigenvector, (A,), (E,))[1]
    reverse = jnp.sum(jax.jacrev(eigenvector)(A) * E[None], axis=(1, 2))
    np.testing.assert_allclose(reverse, forward, atol=1e-4 if A.dtype == jnp.float32 else 1e-13)


@pytest.mark.slow
def test_second_derivative_is_that_of_the_first(theta):
    A, E = theta

    def first(t):
        return jax.jvp(eigenvector, (A + t * E,), (E,))[1]

    second = jax.jvp(first, (0.0,), (1.0,))[1]
    step = 1e-5
    np.testing.assert_allclose(second, (first(step) - first(-step)) / (2 * step), rtol=1e-6, atol=1e-6)


def test_derivatives_pass_through_vmap_and_jit(theta):
    stacked = jnp.stack(theta)
    slope = jax.grad(lambda A: eigenvector(A)[0] ** 2)
    together = jax.jit(jax.vmap(slope))(stacked)
    for k in range(2):
        np.testing.assert_allclose(together[k], slope(stacked[k]), atol=1e-12)


def test_the_start_has_no_derivative(theta):
    A, _ = theta
    z = jnp.linalg.eigh(A)[1][:, 0]
    slope = jax.jacfwd(lambda z: implicit_minimum(rayleigh, SPHERE, z, rayleigh(z, A), A)[0])(z)
    np.testing.assert_array_equal(slope, 0)


def test_the_value_has_the_derivative_at_a_constant_point(theta):
    A, E = theta

    def least(A):
        z = jax.lax.stop_gradient(jnp.linalg.eigh(A)[1][:, 0])
        return implicit_minimum(rayleigh, SPHERE, z, jax.lax.stop_gradient(rayleigh(z, A)), A)[1]

    v = eigenvector(A)
    value, slope = jax.jvp(least, (A,), (E,))
    np.testing.assert_allclose(value, jnp.linalg.eigvalsh(A)[0], rtol=1e-12)
    np.testing.assert_allclose(slope, v @ E @ v, rtol=1e-12)
