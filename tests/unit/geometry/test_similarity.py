"""A similarity maps points, directions and planes consistently, and its inverse maps them back."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity
from symjax.geometry.uncertainty import Uncertainty


def some(rng, *, turned=True, batch=()):
    rotation = np.linalg.qr(rng.normal(size=(*batch, 3, 3)))[0] if turned else None
    return Similarity(np.exp(rng.normal(size=batch)), rotation, rng.normal(size=(*batch, 3)))


@pytest.fixture(params=["rotation", "rotoreflection", "no rotation"])
def similarity(request, rng):
    found = some(rng, turned=request.param != "no rotation")
    if found.rotation is None:
        return found
    sign = np.sign(np.linalg.det(found.rotation)) * (1 if request.param == "rotation" else -1)
    return found._replace(rotation=sign * found.rotation)


def test_points_on_a_plane_stay_on_it(similarity, rng):
    plane = Plane(np.array([0.6, 0.0, -0.8]), np.float64(0.7))
    points = rng.normal(size=(20, 3))
    before = plane.signed_distance(points)
    after = similarity.plane(plane).signed_distance(similarity.points(points))
    np.testing.assert_allclose(after, similarity.scale * before, atol=1e-12)


def test_reflection_commutes_with_the_map(similarity, rng):
    plane = Plane(np.array([0.6, 0.0, -0.8]), np.float64(0.7))
    points = rng.normal(size=(20, 3))
    moved = similarity.plane(plane).reflect(similarity.points(points))
    np.testing.assert_allclose(moved, similarity.points(plane.reflect(points)), atol=1e-12)


def test_distances_are_scaled_and_directions_keep_their_length(similarity, rng):
    points = rng.normal(size=(2, 3))
    moved = similarity.points(points)
    step = similarity.directions(points[1] - points[0])
    np.testing.assert_allclose(similarity.scale * step, moved[1] - moved[0], atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(step), np.linalg.norm(points[1] - points[0]), rtol=1e-12)


def test_an_axis_is_mapped_like_its_points(similarity, rng):
    point, direction = rng.normal(size=(2, 3))
    moved_point, moved_direction = similarity.axis((point, direction))
    np.testing.assert_allclose(moved_point, similarity.points(point), atol=1e-12)
    further = similarity.points(point + direction)
    np.testing.assert_allclose(similarity.scale * moved_direction, further - moved_point, atol=1e-12)


def test_the_inverse_maps_back(similarity, rng):
    points = rng.normal(size=(20, 3))
    np.testing.assert_allclose(similarity.inverse().points(similarity.points(points)), points, atol=1e-12)
    plane = Plane(np.array([0.0, 1.0, 0.0]), np.float64(-2.0))
    back = similarity.inverse().plane(similarity.plane(plane))
    np.testing.assert_allclose(np.append(back.normal, back.offset), [0, 1, 0, -2], atol=1e-12)


def test_a_batch_maps_each_point_by_its_own_similarity(rng):
    batch = some(rng, batch=(5,))
    points = rng.normal(size=(5, 3))
    expected = [Similarity(*(leaf[i] for leaf in batch)).points(points[i]) for i in range(5)]
    np.testing.assert_allclose(batch.points(points), expected, atol=1e-12)
    np.testing.assert_allclose(batch.inverse().points(batch.points(points)), points, atol=1e-12)


def test_a_covariance_is_mapped_like_the_estimates(rng):
    similarity = some(rng)
    truth = Plane(np.array([0.0, 0.0, 1.0]), np.float64(0.2))
    spread = Uncertainty(np.diag([1e-4, 2e-4, 4e-4]), np.eye(3)[:2], np.array([0.5, 0.1, 0.2]))
    other = Plane(np.array([0.01, 0.0, np.sqrt(1 - 1e-4)]), np.float64(0.21))
    moved = similarity.uncertainty(spread)
    distance = moved.distance(similarity.plane(truth), similarity.plane(other))
    assert distance == pytest.approx(spread.distance(truth, other), rel=1e-9)


def test_it_can_be_traced_by_jax(similarity, rng):
    points = rng.normal(size=(20, 3))
    traced = jax.jit(lambda s, x: s.inverse().points(s.points(x)))(jax.tree.map(jnp.asarray, similarity), points)
    np.testing.assert_allclose(traced, points, atol=1e-12)
