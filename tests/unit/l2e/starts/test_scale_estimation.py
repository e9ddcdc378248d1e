"""σ and the inlier fraction are estimated correctly among outliers, in any unit, and for exact pairs."""

import jax.numpy as jnp
import numpy as np
import pytest
import scipy.optimize

from symjax.datasets.planted_pairs import NOISE, planted_pairs
from symjax.errors import InvalidArgumentError
from symjax.geometry.directions import deviation_angle
from symjax.l2e import fit_plane as fit_plane_module
from symjax.l2e.fit_global import fit_global
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.objective import squared_residuals
from symjax.l2e.status import Status

NUM = 2000


def estimated(x, y, **options):
    return fit_global(x, y, "auto", **options)


@pytest.mark.parametrize("outliers", [0.0, 0.3, 0.6, 0.8])
def test_planted_scale_and_inlier_fraction_are_found(outliers):
    fits = []
    for seed in range(5):
        p = planted_pairs(np.random.default_rng(seed), NUM, outliers)
        fits.append(fit := estimated(p.x, p.y))
        assert fit.converged
        assert fit.sigma_estimated
        assert deviation_angle(fit.plane.normal, p.normal) < 1
    off = np.abs([fit.sigma / NOISE - 1 for fit in fits])
    assert np.median(off) < 0.05
    assert off.max() < 0.1
    assert np.median(np.abs([fit.inlier_fraction - (1 - outliers) for fit in fits])) < 0.03


@pytest.mark.parametrize("noise", [0.001, 0.05])
def test_the_scale_follows_the_noise(noise):
    p = planted_pairs(np.random.default_rng(7), NUM, 0.5, noise=noise)
    fit = estimated(p.x, p.y)
    np.testing.assert_allclose(fit.sigma, noise, rtol=0.1)
    np.testing.assert_allclose(fit.inlier_fraction, 0.5, atol=0.05)


@pytest.fixture(scope="module")
def pairs():
    return planted_pairs(np.random.default_rng(51), NUM, 0.6)


@pytest.fixture(scope="module")
def expected(pairs):
    return estimated(pairs.x, pairs.y)


def test_it_is_the_minimum_of_the_partial_density_criterion(pairs, expected):
    """Scott's criterion in its direct form over the plane, σ and ρ, minimised by SciPy."""

    def criterion(z):
        v = z[:3] / np.linalg.norm(z[:3])
        image = pairs.x - 2 * (pairs.x @ v - z[3])[:, None] * v
        f = ((pairs.y - image) ** 2).sum(axis=1)
        sigma, rho = np.exp(z[4]), z[5]
        density = np.exp(-f / (2 * sigma**2)) / (2 * np.pi * sigma**2) ** 1.5
        return rho**2 * (4 * np.pi * sigma**2) ** -1.5 - 2 * rho * density.mean()

    start = np.array([*(pairs.normal + [0.003, -0.002, 0.001]), pairs.offset, np.log(1.2 * NOISE), 0.5])
    # in units in which the criterion and its curvatures are of order one
    unit = np.array([*4 * [NOISE], 1, 1])
    scale = abs(criterion(start))
    found = scipy.optimize.minimize(
        lambda t: criterion(start + unit * t) / scale, np.zeros(6), method="BFGS", options={"gtol": 1e-7}
    )
    z = start + unit * found.x
    normal = z[:3] / np.linalg.norm(z[:3])
    assert deviation_angle(expected.plane.normal, normal) < 1e-3
    np.testing.assert_allclose(expected.sigma, np.exp(z[4]), rtol=1e-4)
    np.testing.assert_allclose(expected.inlier_fraction, z[5], rtol=1e-4)
    np.testing.assert_allclose(expected.loss, criterion(z), rtol=1e-8)


def test_its_scale_is_no_reason_for_a_note_and_its_start_is_kept(expected):
    assert expected.message == Status.SUCCESSFUL.sentence
    assert expected.start.normal.shape == (3,)


def test_share_is_that_of_the_weights(pairs, expected):
    f = squared_residuals(*expected.plane, jnp.asarray(pairs.x), jnp.asarray(pairs.y))
    share = 2**1.5 * jnp.mean(jnp.exp(-f / (2 * expected.sigma**2)))
    np.testing.assert_allclose(expected.inlier_fraction, share, rtol=1e-9)


@pytest.mark.parametrize(("scale", "shift"), [(1e-8, 0.0), (1e8, 1.0), (1.0, 1e3)])
def test_scale_follows_the_unit_and_does_not_depend_on_the_origin(pairs, expected, scale, shift):
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    x, y = (scale * (points @ rotation.T + shift) for points in (pairs.x, pairs.y))
    fit = estimated(x, y)
    rounding = 1e-7 if shift > 1 else 1e-9
    np.testing.assert_allclose(fit.sigma, scale * expected.sigma, rtol=rounding)
    np.testing.assert_allclose(fit.inlier_fraction, expected.inlier_fraction, rtol=rounding)
    np.testing.assert_allclose(fit.loss, expected.loss / scale**3, rtol=10 * rounding)
    assert deviation_angle(fit.plane.normal, rotation @ np.asarray(expected.plane.normal)) < 1e-5


def test_weight_zero_is_absence_and_order_has_no_effect(pairs):
    order = np.random.default_rng(3).permutation(NUM)
    x, y = pairs.x[order], pairs.y[order]
    absent = np.arange(NUM) % 4 == 0
    given = estimated(x[~absent], y[~absent])
    hidden = estimated(np.where(absent[:, None], 1e3, x), np.where(absent[:, None], -1e3, y), weights=~absent)
    backwards = estimated(x[~absent][::-1], y[~absent][::-1])
    for fit in (hidden, backwards):
        np.testing.assert_allclose(fit.sigma, given.sigma, rtol=1e-8)
        np.testing.assert_allclose(fit.inlier_fraction, given.inlier_fraction, rtol=1e-8)
        np.testing.assert_allclose(fit.plane.normal, given.plane.normal, atol=1e-8)


@pytest.mark.parametrize("outliers", [0.0, 0.5])
def test_exact_pairs_have_almost_no_scale(outliers):
    p = planted_pairs(np.random.default_rng(8), NUM, outliers, noise=0.0)
    fit = estimated(p.x, p.y)
    assert fit.converged
    assert 0 < fit.sigma < 1e-6
    assert np.isfinite([fit.loss, fit.inlier_fraction, fit.grad_norm]).all()
    assert deviation_angle(fit.plane.normal, p.normal) < 1e-6


def test_no_mirror_pairs_at_all_give_no_small_scale():
    """A plane fits any single pair exactly. Such a plane is not a valid optimum."""
    p = planted_pairs(np.random.default_rng(9), NUM, 1.0)
    fit = estimated(p.x, p.y)
    assert np.isfinite([fit.loss, fit.sigma, fit.inlier_fraction]).all()
    assert fit.sigma > 20 * NOISE


@pytest.mark.slow
@pytest.mark.any_precision
def test_float32_stays_float32():
    p = planted_pairs(np.random.default_rng(10), NUM, 0.5)
    fit = estimated(np.float32(p.x), np.float32(p.y))
    assert fit.sigma.dtype == fit.inlier_fraction.dtype == fit.loss.dtype == jnp.float32
    assert fit.converged
    np.testing.assert_allclose(fit.sigma, NOISE, rtol=0.1)
    np.testing.assert_allclose(fit.inlier_fraction, 0.5, atol=0.03)
    exact = planted_pairs(np.random.default_rng(10), NUM, 0.5, noise=0.0)
    fit = estimated(np.float32(exact.x), np.float32(exact.y))
    assert fit.converged
    assert 0 < fit.sigma < 2e-3


@pytest.mark.parametrize("solver", ["irls", "rbfgs", "alternating"])
def test_only_newton_estimates(monkeypatch, solver):
    monkeypatch.setattr(fit_plane_module, "_fit_plane", None)
    with pytest.raises(InvalidArgumentError, match="estimated with solver='newton'"):
        fit_plane(np.eye(3), np.eye(3)[::-1], "auto", solver=solver)
    with pytest.raises(InvalidArgumentError, match="or 'auto', got 'Auto'"):
        fit_plane(np.eye(3), np.eye(3)[::-1], "Auto")


@pytest.mark.parametrize("num_pairs", [3, 8, 15])
def test_few_pairs_do_not_converge(num_pairs):
    p = planted_pairs(np.random.default_rng(0), num_pairs, 0.0)
    fit = estimated(p.x, p.y)
    assert not fit.converged
    assert "fewer than 20" in fit.message


def test_a_plane_supported_by_few_of_many_pairs_does_not_converge():
    converged = []
    for seed in range(6):
        p = planted_pairs(np.random.default_rng(seed), 200, 0.8)
        fit = estimated(p.x, p.y)
        converged.append(bool(fit.converged))
        assert fit.converged == (fit.inlier_fraction * 200 >= 20)
        assert not fit.converged or deviation_angle(fit.plane.normal, p.normal) < 1
    assert any(converged)
