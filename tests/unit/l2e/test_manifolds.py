import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.l2e import manifolds
from symjax.l2e.manifolds import SPHERE, SPHERE_LINE
from tests.helpers.formulas import exponential


@pytest.fixture
def v_u():
    v, w = manifolds.random_points(jax.random.key(3), 2)
    return v, 0.7 * manifolds.tangent_projection(v, w)


@pytest.mark.any_precision
def test_projection_is_tangent_and_idempotent(v_u):
    v, _ = v_u
    u = manifolds.tangent_projection(v, jnp.asarray([1.0, 2.0, 3.0]))
    np.testing.assert_allclose(u @ v, 0, atol=1e-6)
    np.testing.assert_allclose(manifolds.tangent_projection(v, u), u, atol=1e-6)


def test_exponential_moves_by_the_length_of_the_tangent(v_u):
    v, u = v_u
    w = exponential(v, u)
    np.testing.assert_allclose(jnp.arccos(v @ w), jnp.linalg.norm(u), rtol=1e-12)
    np.testing.assert_array_equal(exponential(v, jnp.zeros(3)), v)
    np.testing.assert_allclose(jax.jacfwd(lambda t: exponential(v, t))(jnp.zeros(3)) @ u, u, atol=1e-14)


def test_retraction_agrees_with_the_exponential_to_second_order(v_u):
    v, u = v_u
    steps = np.array([1e-1, 1e-2, 1e-3])
    gaps = [jnp.linalg.norm(manifolds.retract(v, t * u) - exponential(v, t * u)) for t in steps]
    slope = np.polyfit(np.log(steps), np.log(gaps), 1)[0]
    assert slope == pytest.approx(3, abs=0.05)


def test_transport_is_an_isometry_along_the_geodesic(v_u):
    v, u = v_u
    w = exponential(v, u)
    T = manifolds.transport(v, w)
    np.testing.assert_allclose(T @ T.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(T @ v, w, atol=1e-14)
    # the velocity of the geodesic at its end, by differentiation
    _, velocity = jax.jvp(lambda t: exponential(v, t * u), (1.0,), (1.0,))
    np.testing.assert_allclose(T @ u, velocity, atol=1e-14)
    np.testing.assert_allclose(T @ jnp.cross(v, u), jnp.cross(v, u), atol=1e-14)


@pytest.mark.parametrize("manifold", [SPHERE, SPHERE_LINE], ids=["sphere", "sphere_line"])
def test_basis_is_orthonormal_and_tangent_everywhere(manifold):
    extra = manifold is SPHERE_LINE
    poles = jnp.asarray([[0, 0, 1.0], [0, 0, -1.0], [1.0, 0, 0]])
    for v in jnp.concatenate([poles, manifolds.random_points(jax.random.key(0), 5)]):
        z = jnp.append(v, 0.4) if extra else v
        B = manifold.basis(z)
        np.testing.assert_allclose(B.T @ B, np.eye(2 + extra), atol=1e-14)
        for column in B.T:
            np.testing.assert_allclose(manifold.project(z, column), column, atol=1e-14)


def test_the_line_adds_a_flat_coordinate(v_u):
    v, u = v_u
    z, t = jnp.append(v, 5.0), jnp.append(u, -2.0)
    w = SPHERE_LINE.retract(z, t)
    np.testing.assert_allclose(w, jnp.append(manifolds.retract(v, u), 3.0))
    np.testing.assert_allclose(
        SPHERE_LINE.transport(z, w) @ jnp.append(u, 1.0), jnp.append(manifolds.transport(v, w[:3]) @ u, 1.0)
    )


def test_random_points_are_uniform():
    points = np.asarray(manifolds.random_points(jax.random.key(1), 20_000))
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1)
    np.testing.assert_allclose(points.mean(axis=0), 0, atol=0.02)
    np.testing.assert_allclose(points.T @ points / len(points), np.eye(3) / 3, atol=0.01)
