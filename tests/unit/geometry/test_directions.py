import numpy as np
import pytest

from symjax.geometry.directions import fibonacci


@pytest.mark.any_precision
@pytest.mark.parametrize("half", [True, False])
def test_fibonacci_directions_are_unit_vectors_and_cover_the_sphere(half):
    points = fibonacci(64, half=half)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1, atol=1e-15)
    directions = np.random.default_rng(0).normal(size=(2000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    cosine = directions @ points.T
    nearest = (np.abs(cosine) if half else cosine).max(axis=1)
    # discs of equal area around 64 points have a radius of 10 degrees on the half sphere, and 14 on the whole sphere
    assert np.degrees(np.arccos(nearest.min())) < (18 if half else 24)
    assert not half or (points[:, 2] > 0).all()
