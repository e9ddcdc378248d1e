"""`fit_global` finds the best plane without a start: among few inliers, in any unit and about any origin."""

import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError, NonfiniteError
from symjax.geometry.directions import deviation_angle
from symjax.l2e import fit_global as fit_global_module
from symjax.l2e.fit_global import fit_global
from symjax.l2e.fit_plane import fit_plane
from tests.helpers.structured_pairs import structured_pairs

NUM, SIGMA = 1000, 0.03  # one number of pairs in most tests: one compilation
SEEDS = range(6)


def same_plane(plane, normal, offset, **tolerance):
    side = np.sign(np.sum(np.asarray(plane.normal) * normal))
    np.testing.assert_allclose(side * plane.normal, normal, **tolerance)
    np.testing.assert_allclose(side * plane.offset, offset, **tolerance)


def assert_found(fit, p, angle=1.0):
    """Checks that the fit is the planted plane, with a loss no higher than that of the fit started there."""
    assert fit.converged
    assert deviation_angle(fit.plane.normal, p.normal) < angle
    there = fit_plane(p.x, p.y, float(fit.sigma), p.normal)
    assert fit.loss <= there.loss + 1e-9 * abs(there.loss)


@pytest.mark.parametrize("blob", ["isotropic", "thin", "wide"])
def test_among_95_per_cent_outliers(blob):
    for seed in SEEDS:
        p = planted_pairs(np.random.default_rng(seed), NUM, 0.95, blob)
        assert_found(fit_global(p.x, p.y, SIGMA), p)


@pytest.mark.parametrize("sigma", [0.01, 0.02, 0.03])
def test_among_90_per_cent_outliers_of_which_half_follow_a_second_plane(sigma):
    for seed in SEEDS:
        p, _ = structured_pairs(seed, NUM)
        assert_found(fit_global(p.x, p.y, sigma), p)


@pytest.mark.slow
def test_with_more_pairs_than_in_the_first_refinement():
    for seed in SEEDS:
        p = planted_pairs(np.random.default_rng(seed), 3 * NUM, 0.95)
        assert_found(fit_global(p.x, p.y, SIGMA), p)
        p, _ = structured_pairs(seed, 3 * NUM)
        assert_found(fit_global(p.x, p.y, 0.02), p)


def test_at_a_large_scale_the_second_plane_is_the_better():
    """The criterion alone decides, and this is its optimum at that scale."""
    p, (normal, offset) = structured_pairs(0, NUM)
    fit = fit_global(p.x, p.y, 0.2)
    assert deviation_angle(fit.plane.normal, normal) < 2
    assert fit.loss < fit_plane(p.x, p.y, 0.2, p.normal).loss
    same_plane(fit.plane, normal, offset, atol=0.05)


@pytest.fixture(scope="module")
def pairs():
    return planted_pairs(np.random.default_rng(31), NUM, 0.8)


@pytest.fixture(scope="module")
def expected(pairs):
    fit = fit_global(pairs.x, pairs.y, SIGMA)
    assert_found(fit, pairs)
    return fit


@pytest.mark.parametrize(("scale", "shift"), [(1.0, 0.0), (1e-6, 1.0), (1e6, 3.0), (1.0, 1e4)])
def test_the_plane_moves_with_the_pairs(pairs, expected, scale, shift):
    rotation = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    move = scale * shift * np.array([0.3, -1.0, 0.5])
    x, y = (scale * points @ rotation.T + move for points in (pairs.x, pairs.y))
    fit = fit_global(x, y, scale * SIGMA)
    assert fit.converged
    normal = rotation @ np.asarray(expected.plane.normal)
    rounding = 1e-8 * max(1, 1e-4 * shift)
    same_plane(fit.plane._replace(offset=0.0), normal, 0.0, atol=rounding)
    foot = scale * (rotation @ np.asarray(expected.plane.normal)) * float(expected.plane.offset) + move
    np.testing.assert_allclose(fit.plane.signed_distance(foot[None]) / scale, 0, atol=rounding)
    np.testing.assert_allclose(fit.loss * scale**3, expected.loss, rtol=1e-6)
    np.testing.assert_allclose(fit.inlier_fraction, expected.inlier_fraction, rtol=1e-6)


def test_neither_the_ends_nor_the_order_of_the_pairs_matter(pairs, expected):
    order = np.random.default_rng(2).permutation(NUM)
    swap = (np.arange(NUM) % 3 == 0)[:, None]
    x, y = np.where(swap, pairs.y, pairs.x), np.where(swap, pairs.x, pairs.y)
    for a, b in ((x, y), (pairs.x[order], pairs.y[order]), (pairs.x[::-1], pairs.y[::-1])):
        fit = fit_global(a, b, SIGMA)
        same_plane(fit.plane, np.asarray(expected.plane.normal), float(expected.plane.offset), atol=1e-9)
        np.testing.assert_allclose(fit.loss, expected.loss, rtol=1e-10)


@pytest.mark.parametrize("first", [0, 1, 2])
@pytest.mark.parametrize("junk", [1e3, 1e100, 1e200])
def test_weight_zero_is_absence(pairs, first, junk):
    absent = np.arange(NUM) % 3 == first
    given = fit_global(pairs.x[~absent], pairs.y[~absent], SIGMA)
    x, y = (np.where(absent[:, None], far, points) for far, points in ((junk, pairs.x), (-junk, pairs.y)))
    hidden = fit_global(x, y, SIGMA, weights=~absent)
    assert hidden.converged
    same_plane(hidden.plane, np.asarray(given.plane.normal), float(given.plane.offset), atol=1e-9)
    np.testing.assert_allclose(hidden.loss, given.loss, rtol=1e-9)


def test_integer_weights_are_repeated_pairs(pairs):
    counts = np.arange(NUM) % 3
    repeated = (np.repeat(points, counts, axis=0) for points in (pairs.x, pairs.y))
    once, again = fit_global(pairs.x, pairs.y, SIGMA, weights=counts), fit_global(*repeated, SIGMA)
    same_plane(once.plane, np.asarray(again.plane.normal), float(again.plane.offset), atol=1e-9)
    np.testing.assert_allclose(once.loss, again.loss, rtol=1e-10)


@pytest.mark.parametrize("far", [1e3, 1e6, 1e8, 1e10, 1e25])
def test_one_far_pair_has_no_effect(pairs, expected, far):
    """At any distance, even if the rounding error of its f exceeds σ²."""
    rng = np.random.default_rng(6)
    for _ in range(8):
        x, y = pairs.x.copy(), pairs.y.copy()
        x[0], y[0] = far * rng.normal(size=(2, 3))
        fit = fit_global(x, y, SIGMA)
        assert fit.converged
        np.testing.assert_allclose(fit.inlier_fraction, expected.inlier_fraction, rtol=0.01)
        same_plane(fit.plane, np.asarray(expected.plane.normal), float(expected.plane.offset), atol=1e-3)


@pytest.mark.any_precision
def test_float32_stays_float32_and_finds_it():
    for seed in SEEDS:
        p = planted_pairs(np.random.default_rng(seed), NUM, 0.9)
        fit = fit_global(np.float32(p.x), np.float32(p.y), SIGMA)
        assert fit.plane.normal.dtype == fit.plane.offset.dtype == fit.loss.dtype == jnp.float32
        assert fit.converged
        assert deviation_angle(np.asarray(fit.plane.normal, float), p.normal) < 1


def test_pairs_of_length_zero_give_no_false_plane():
    """Points on the plane are their own mirror images and propose no plane."""
    x = np.random.default_rng(4).normal(size=(NUM, 3)) * [1, 1, 0]
    fit = fit_global(x, x, SIGMA)
    unit = abs(np.linalg.norm(fit.plane.normal) - 1) < 1e-9
    assert unit or not fit.converged


GOOD = {"x": np.eye(3), "y": np.eye(3)[::-1], "sigma": 0.1}


@pytest.mark.parametrize(
    ("change", "error", "match"),
    [
        ({"sigma": 0.0}, InvalidArgumentError, "sigma must be positive"),
        ({"sigma": "automatic"}, InvalidArgumentError, "or 'auto', got 'automatic'"),
        ({"sigma": [0.1]}, InvalidArgumentError, "shape"),
        ({"num_hypotheses": 0}, InvalidArgumentError, "num_hypotheses must be a whole number, at least 1, got 0"),
        ({"num_hypotheses": 2.5}, InvalidArgumentError, "num_hypotheses"),
        ({"num_refined": -1}, InvalidArgumentError, "num_refined"),
        ({"max_steps": -1}, InvalidArgumentError, "max_steps"),
        ({"tol": -1e-9}, InvalidArgumentError, "tol"),
        ({"weights": [1, 1, -1]}, InvalidArgumentError, r"weights\[2\]"),
        ({"weights": np.zeros(3)}, InvalidArgumentError, "every weight is zero"),
        ({"y": np.full((3, 3), np.nan)}, NonfiniteError, "y has NaN"),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, dict) else None,
)
def test_bad_arguments_are_refused_before_anything_is_computed(monkeypatch, change, error, match):
    monkeypatch.setattr(fit_global_module, "_fit_global", None)
    with pytest.raises(error, match=match):
        fit_global(**{**GOOD, **change})


@pytest.mark.slow
def test_few_pairs_hypotheses_and_planes_suffice():
    x = np.array([[1.0, 0, 2], [0, 1, 1], [2, 1, 3]])
    fit = fit_global(x, x * [1, 1, -1], 0.5, num_hypotheses=2, num_refined=1)
    assert fit.converged
    np.testing.assert_allclose(fit.plane.normal, [0, 0, 1], atol=1e-9)
