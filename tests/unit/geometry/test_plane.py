import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.geometry.plane import Plane


def planes(rng, num=6):
    normal = rng.normal(size=(num, 3))
    return Plane(normal / np.linalg.norm(normal, axis=1, keepdims=True), rng.normal(size=num))


@pytest.mark.parametrize("xp", [np, jnp], ids=["numpy", "jax"])
def test_reflection_is_an_involution_that_fixes_the_plane_and_flips_distances(rng, xp):
    plane, points = Plane(*map(xp.asarray, planes(rng))), xp.asarray(rng.normal(size=(10, 3)))
    image = plane.reflect(points)
    assert image.shape == (6, 10, 3)
    for k in range(6):
        one = Plane(plane.normal[k], plane.offset[k])
        np.testing.assert_allclose(one.reflect(points), image[k], atol=1e-14)
        np.testing.assert_allclose(one.reflect(image[k]), points, atol=1e-14)
        np.testing.assert_allclose(one.signed_distance(image[k]), -one.signed_distance(points), atol=1e-14)
        middle = (points + image[k]) / 2
        np.testing.assert_allclose(one.signed_distance(middle), 0, atol=1e-14)


@pytest.mark.parametrize("xp", [np, jnp], ids=["numpy", "jax"])
def test_matrix_is_the_reflection_with_determinant_minus_one(rng, xp):
    plane, points = Plane(*map(xp.asarray, planes(rng))), rng.normal(size=(10, 3))
    matrix = plane.matrix()
    homogeneous = np.concatenate([points, np.ones((10, 1))], axis=1)
    np.testing.assert_allclose(
        np.einsum("bij,nj->bni", matrix, homogeneous)[..., :3], plane.reflect(points), atol=1e-14
    )
    np.testing.assert_allclose(np.linalg.det(matrix), -1)
    np.testing.assert_allclose(plane.matrix()[0], Plane(plane.normal[0], plane.offset[0]).matrix())


@pytest.mark.any_precision
@pytest.mark.parametrize("xp", [np, jnp], ids=["numpy", "jax"])
def test_directions_are_reflected_like_differences_of_points(rng, xp):
    plane, points = Plane(*map(xp.asarray, planes(rng))), xp.asarray(rng.normal(size=(2, 10, 3)))
    apart = plane.reflect(points[1]) - plane.reflect(points[0])
    rounding = 20 * np.finfo(points.dtype).eps
    np.testing.assert_allclose(plane.reflect_directions(points[1] - points[0]), apart, atol=rounding)


@pytest.mark.parametrize("xp", [np, jnp], ids=["numpy", "jax"])
def test_canonical_sign_is_the_same_for_both_orientations(rng, xp):
    plane = Plane(*map(xp.asarray, planes(rng)))
    a, b = plane.canonical(), Plane(-plane.normal, -plane.offset).canonical()
    np.testing.assert_array_equal(a.normal, b.normal)
    np.testing.assert_array_equal(a.offset, b.offset)
    assert (np.take_along_axis(np.asarray(a.normal), np.abs(a.normal).argmax(1)[:, None], 1) > 0).all()
    assert a.normal.dtype == plane.normal.dtype


def test_canonical_sign_of_a_tie_follows_the_first_component():
    s = np.sqrt(0.5)
    assert Plane(np.array([-s, 0.0, s]), np.float64(1.0)).canonical().normal[0] > 0


def test_angle_ignores_orientation(rng):
    plane = planes(rng)
    np.testing.assert_allclose(plane.angle(Plane(-plane.normal, -plane.offset)), 0, atol=1e-12)
    right = Plane(np.cross(plane.normal, [1.0, 2.0, 3.0]), plane.offset)
    np.testing.assert_allclose(plane.angle(right), 90)


def test_a_plane_is_a_pytree(rng):
    points = jnp.asarray(rng.normal(size=(4, 3)))
    plane = Plane(*map(jnp.asarray, planes(rng)))
    distances = jax.jit(jax.vmap(lambda p: p.signed_distance(points)))(plane)
    np.testing.assert_allclose(distances, plane.signed_distance(points), atol=1e-14)
