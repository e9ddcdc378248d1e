import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.geometry.directions import deviation_angle
from symjax.geometry.distance import offset_error
from symjax.geometry.plane import Plane


@pytest.mark.parametrize("degrees", [0.0, 1e-9, 1e-3, 7.0, 45.0, 90.0])
def test_angle_is_exact_from_nanodegrees_to_a_right_angle(degrees):
    radians = np.radians(degrees)
    a, b = np.array([0.0, 0.0, 1.0]), np.array([np.sin(radians), 0.0, np.cos(radians)])
    assert deviation_angle(a, b) == pytest.approx(degrees, rel=1e-12)
    assert deviation_angle(a, -b) == pytest.approx(degrees, rel=1e-12)


def test_angle_of_a_batch_in_numpy_and_in_jax(rng):
    a, b = rng.normal(size=(5, 3)), rng.normal(size=3)
    cosine = np.abs(a @ b) / np.linalg.norm(a, axis=1) / np.linalg.norm(b)
    np.testing.assert_allclose(deviation_angle(a, b), np.degrees(np.arccos(cosine)), rtol=1e-9)
    np.testing.assert_allclose(deviation_angle(jnp.asarray(a), jnp.asarray(b)), deviation_angle(a, b), rtol=1e-12)


@pytest.mark.any_precision
def test_angle_has_a_finite_derivative_at_aligned_normals():
    v = jnp.asarray([0.0, 0.6, 0.8])
    assert jnp.isfinite(jax.grad(lambda u: deviation_angle(u, v))(v)).all()


def test_offset_error_does_not_depend_on_the_origin(rng):
    truth = Plane(np.array([0.0, 0.6, 0.8]), np.float64(2.0))
    normal = np.array([0.1, 0.6, 0.8])
    normal /= np.linalg.norm(normal)
    plane, centre = Plane(normal, np.float64(2.1)), rng.normal(size=3)
    error = offset_error(plane, truth, centre, 4.0)
    shift = 100 * rng.normal(size=3)
    moved = [Plane(p.normal, p.offset + p.normal @ shift) for p in (plane, truth)]
    assert offset_error(*moved, centre + shift, 4.0) == pytest.approx(error, rel=1e-9)
    flipped = Plane(-plane.normal, -plane.offset)
    assert offset_error(flipped, truth, centre, 4.0) == pytest.approx(error, rel=1e-12)


def test_offset_error_of_a_parallel_plane_is_its_distance():
    truth = Plane(np.array([0.0, 0.0, 1.0]), np.float64(1.0))
    planes = Plane(np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]), np.array([1.5, -3.0]))
    np.testing.assert_allclose(offset_error(planes, truth, np.ones(3), 2.0), [0.25, 1.0])
