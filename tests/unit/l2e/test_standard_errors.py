"""Standard errors match the spread of the estimates, and the confidence regions have their nominal coverage."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax import standard_errors
from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError, InvalidPointsError
from symjax.geometry.plane import Plane
from symjax.l2e.fit_plane import fit_plane

NUM, NOISE, OUTLIERS = 1000, 0.02, 0.5


def drawn(seed):
    """Pairs that are outliers independently with the same probability, so that their number is random."""
    rng = np.random.default_rng(seed)
    return planted_pairs(rng, NUM, rng.binomial(NUM, OUTLIERS) / NUM, noise=NOISE)


def plane_of(fit):
    return Plane(np.asarray(fit.plane.normal), np.asarray(fit.plane.offset))


def trial(seed, sigma):
    """Squared errors of one fit (rotation, offset, σ, ρ), their expectation, and whether the region is correct."""
    p = drawn(seed)
    fit = fit_plane(p.x, p.y, sigma, p.normal)
    found = standard_errors(fit, p.x, p.y)
    plane, side = plane_of(fit), np.sign(p.normal @ np.asarray(fit.plane.normal))
    turn = found.plane.tangents @ p.normal
    centre = found.plane.centre
    shift = side * (p.offset - p.normal @ centre) - (plane.offset - plane.normal @ centre)
    errors = turn @ turn, shift**2, (fit.sigma - NOISE) ** 2, (fit.inlier_fraction - 1 + OUTLIERS) ** 2
    expected = np.radians(found.plane.normal_degrees), found.plane.offset, found.sigma, found.inlier_fraction
    return errors, np.square(expected), found.plane.contains(plane, Plane(p.normal, np.float64(p.offset)))


@pytest.mark.parametrize(("sigma", "trials"), [(NOISE, 300), pytest.param("auto", 200, marks=pytest.mark.slow)])
def test_they_match_the_spread_and_the_region_has_its_coverage(sigma, trials):
    errors, expected, inside = zip(*(trial(1000 + k, sigma) for k in range(trials)), strict=True)
    ratio = np.sqrt(np.mean(errors, axis=0)[[0, 1, 3]] / np.mean(expected, axis=0)[[0, 1, 3]])
    np.testing.assert_allclose(ratio, 1, atol=0.15)
    assert abs(np.mean(inside) - 0.95) < 3 * np.sqrt(0.95 * 0.05 / trials)
    spread = np.sqrt(np.mean(expected, axis=0)[2])
    if sigma == "auto":
        np.testing.assert_allclose(np.sqrt(np.mean(errors, axis=0)[2]) / spread, 1, atol=0.15)
    else:
        assert spread == 0


@pytest.fixture(scope="module")
def pairs():
    return drawn(1)


def errors_of(x, y, sigma=NOISE, v0=None, weights=None):
    fit = fit_plane(x, y, sigma, v0, weights=weights)
    return fit, standard_errors(fit, x, y, weights=weights)


@pytest.fixture(scope="module")
def given(pairs):
    return errors_of(pairs.x, pairs.y, v0=pairs.normal)


def test_they_are_the_infinitesimal_jackknife(pairs, given):
    """The derivatives of the fit in the weights, squared and summed, estimate the same covariance."""
    _, found = given

    @jax.jit
    @jax.jacrev
    def moves(weights):
        fit = fit_plane(pairs.x, pairs.y, NOISE, pairs.normal, weights=weights)
        distance = fit.plane.offset - jnp.sum(fit.plane.normal * found.plane.centre)
        return jnp.concatenate([fit.plane.normal, distance[None], fit.inlier_fraction[None]])

    J = np.asarray(moves(jnp.ones(NUM)))
    J = np.concatenate([found.plane.tangents @ J[:3], J[3:]])
    covariance = J @ J.T
    few = NUM / (NUM - 5)  # five numbers are fitted
    np.testing.assert_allclose(found.plane.covariance, few * covariance[:3, :3], atol=1e-6 * covariance[:3, :3].max())
    np.testing.assert_allclose(found.inlier_fraction, np.sqrt(few * covariance[3, 3]), rtol=1e-6)


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e6, 1.0), (1.0, 30.0)])
def test_they_scale_with_the_unit_and_do_not_depend_on_the_origin(pairs, given, scale, shift):
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    x, y = (scale * (points @ rotation.T + shift) for points in (pairs.x, pairs.y))
    fit, found = errors_of(x, y, scale * NOISE, rotation @ pairs.normal)
    expected = given[1]
    np.testing.assert_allclose(found.plane.normal_degrees, expected.plane.normal_degrees, rtol=1e-6)
    np.testing.assert_allclose(found.plane.offset, scale * expected.plane.offset, rtol=1e-6)
    np.testing.assert_allclose(found.inlier_fraction, expected.inlier_fraction, rtol=1e-6)
    np.testing.assert_allclose(found.plane.centre, scale * (rotation @ expected.plane.centre + shift), rtol=1e-6)
    # the distance to the true plane in standard errors does not change
    normal = rotation @ pairs.normal
    truth = Plane(normal, scale * (pairs.offset + shift * normal.sum()))
    before = expected.plane.distance(plane_of(given[0]), Plane(pairs.normal, np.float64(pairs.offset)))
    np.testing.assert_allclose(found.plane.distance(plane_of(fit), truth), before, rtol=1e-5)


def test_they_depend_on_the_number_of_inliers(pairs, given):
    """Half of the inliers give standard errors √2 times as large."""
    inlier = np.flatnonzero(pairs.inlier)[::2]
    rows = np.concatenate([np.flatnonzero(~pairs.inlier), inlier])
    _, found = errors_of(pairs.x[rows], pairs.y[rows], v0=pairs.normal)
    ratio = found.plane.normal_degrees / given[1].plane.normal_degrees
    np.testing.assert_allclose(ratio, np.sqrt(2), rtol=0.15)


def test_a_common_factor_of_the_weights_has_no_effect_and_repeated_pairs_count_as_independent(pairs, given):
    """Pairs that are listed twice count as twice as many independent pairs."""
    expected = given[1]
    _, heavy = errors_of(pairs.x, pairs.y, v0=pairs.normal, weights=np.full(NUM, 3.0))
    np.testing.assert_allclose(heavy.plane.covariance, expected.plane.covariance, rtol=1e-8)
    some = np.arange(NUM) >= NUM // 2  # the inliers among them
    _, once = errors_of(pairs.x, pairs.y, v0=pairs.normal, weights=some)
    x, y = (np.tile(points[some], (2, 1)) for points in (pairs.x, pairs.y))
    _, twice = errors_of(x, y, v0=pairs.normal)
    np.testing.assert_allclose(twice.plane.normal_degrees, once.plane.normal_degrees / np.sqrt(2), rtol=0.01)


def test_weight_zero_is_absence(pairs):
    absent = np.arange(NUM) % 5 == 2
    _, expected = errors_of(pairs.x[~absent], pairs.y[~absent], v0=pairs.normal)
    x, y = (np.where(absent[:, None], far, points) for far, points in ((1e3, pairs.x), (-1e3, pairs.y)))
    _, found = errors_of(x, y, v0=pairs.normal, weights=~absent)
    np.testing.assert_allclose(found.plane.covariance, expected.plane.covariance, rtol=1e-7)
    np.testing.assert_allclose(found.plane.centre, expected.plane.centre, atol=1e-9)
    np.testing.assert_allclose(found.inlier_fraction, expected.inlier_fraction, rtol=1e-7)


@pytest.mark.slow
def test_exact_pairs_have_almost_no_error():
    p = planted_pairs(np.random.default_rng(2), NUM, 0.5, noise=0.0)
    for sigma in (NOISE, "auto"):
        fit, found = errors_of(p.x, p.y, sigma, p.normal)
        assert np.isfinite(found.plane.covariance).all()
        assert np.isfinite(found.sigma)
        assert fit.converged
    assert found.plane.normal_degrees < 1e-6
    assert found.plane.offset < 1e-8


def test_several_fits_at_once_are_refused(pairs, given):
    fits = jax.tree.map(lambda leaf: jnp.stack([leaf, leaf])[None], given[0])
    with pytest.raises(InvalidArgumentError, match=r"batch of fits of shape \(1, 2\)"):
        standard_errors(fits, pairs.x, pairs.y)


def test_pairs_are_checked(pairs, given):
    with pytest.raises(InvalidPointsError, match="mirror image"):
        standard_errors(given[0], pairs.x, pairs.y[1:])
