"""The confidence region contains the truth as often as its level says, in any units and for either sign."""

import numpy as np
import pytest
from scipy.stats import chi2, kstest

from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty

COVARIANCE = np.array([[4e-4, 1e-4, 3e-5], [1e-4, 1e-4, -1e-5], [3e-5, -1e-5, 2.5e-5]])


def tangents_of(normal):
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first)])


@pytest.fixture(scope="module")
def truth():
    normal = np.array([0.48, -0.6, 0.64])
    return Plane(normal, np.float64(2.0))


@pytest.fixture(scope="module")
def uncertainty(truth):
    return Uncertainty(COVARIANCE, tangents_of(truth.normal), np.array([3.0, -2.0, 1.0]))


def draws(truth, uncertainty, count, rng):
    """Planes whose rotation towards the tangents, and shift at the centre, have the planted covariance."""
    steps = rng.multivariate_normal(np.zeros(3), uncertainty.covariance, size=count, method="cholesky")
    for step in steps:
        # the inverse of the chart: a normal whose components along the tangents are the rotation
        turn = step[:2] @ uncertainty.tangents
        normal = turn + np.sqrt(1 - turn @ turn) * truth.normal
        shift = truth.offset - truth.normal @ uncertainty.centre + step[2]
        yield step, Plane(normal, normal @ uncertainty.centre + shift)


@pytest.mark.parametrize("level", [0.5, 0.95])
def test_the_region_contains_the_truth_at_its_level(truth, uncertainty, rng, level):
    inside = [uncertainty.contains(truth, plane, level=level) for _, plane in draws(truth, uncertainty, 2_000, rng)]
    assert abs(np.mean(inside) - level) < 4 * np.sqrt(level * (1 - level) / 2_000)


def test_the_distance_is_mahalanobis(truth, uncertainty, rng):
    found, expected = [], []
    for step, plane in draws(truth, uncertainty, 1_000, rng):
        found.append(uncertainty.distance(truth, plane))
        expected.append(np.sqrt(step @ np.linalg.solve(COVARIANCE, step)))
    np.testing.assert_allclose(found, expected, rtol=1e-9)
    assert kstest(np.square(found), chi2(df=3).cdf).pvalue > 1e-3


def test_the_estimate_is_at_distance_zero_from_itself_and_far_planes_are_outside(truth, uncertainty):
    assert uncertainty.distance(truth, truth) < 1e-9
    assert uncertainty.contains(truth, truth, level=0.01)
    assert not uncertainty.contains(truth, Plane(truth.normal, truth.offset + 0.1))
    assert not uncertainty.contains(truth, Plane(np.array([0.0, 0.0, 1.0]), np.float64(1.0)))


def test_the_sign_of_a_plane_does_not_matter(truth, uncertainty, rng):
    opposite = Plane(-truth.normal, -truth.offset)
    for _, plane in draws(truth, uncertainty, 50, rng):
        other = Plane(-plane.normal, -plane.offset)
        distance = uncertainty.distance(truth, plane)
        for estimate, second in ((truth, other), (opposite, plane), (opposite, other)):
            assert uncertainty.distance(estimate, second) == pytest.approx(distance, rel=1e-9)


@pytest.mark.parametrize("scale", [1e-6, 1e3])
def test_units_and_position_do_not_matter(truth, uncertainty, rng, scale):
    move = np.array([10.0, -20.0, 5.0]) * scale

    def there(plane):
        return Plane(plane.normal, scale * plane.offset + plane.normal @ move)

    factors = np.array([1, 1, scale])
    moved = uncertainty._replace(
        covariance=COVARIANCE * np.outer(factors, factors), centre=scale * uncertainty.centre + move
    )
    for _, plane in draws(truth, uncertainty, 50, rng):
        assert moved.distance(there(truth), there(plane)) == pytest.approx(uncertainty.distance(truth, plane), rel=1e-5)
    assert moved.normal_degrees == pytest.approx(uncertainty.normal_degrees)
    assert moved.offset == pytest.approx(scale * uncertainty.offset)


def test_standard_errors_are_the_standard_deviations_of_the_draws(truth, uncertainty, rng):
    angles, shifts = [], []
    for step, plane in draws(truth, uncertainty, 4_000, rng):
        angles.append(plane.angle(truth))
        shifts.append(step[2])
    assert uncertainty.normal_degrees == pytest.approx(np.sqrt(np.mean(np.square(angles))), rel=0.05)
    assert uncertainty.offset == pytest.approx(np.std(shifts), rel=0.05)


def test_other_tangents_with_their_own_covariance_define_the_same_region(truth, uncertainty, rng):
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    whole = np.eye(3)
    whole[:2, :2] = turn
    other = uncertainty._replace(tangents=turn @ uncertainty.tangents, covariance=whole @ COVARIANCE @ whole.T)
    for _, plane in draws(truth, uncertainty, 50, rng):
        assert other.distance(truth, plane) == pytest.approx(uncertainty.distance(truth, plane), rel=1e-9)


def test_a_singular_covariance_does_not_raise(truth, uncertainty):
    flat = uncertainty._replace(covariance=np.diag([1e-4, 1e-4, 0.0]))
    tilted = Plane(truth.normal + 0.01 * uncertainty.tangents[0], truth.offset)
    assert np.isfinite(flat.distance(truth, tilted))
    assert flat.offset == 0
