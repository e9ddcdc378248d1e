"""The features give the direct residuals, ignore padding, and do not depend on the tiles."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e import features, objective
from symjax.l2e.criterion import Criterion
from symjax.l2e.manifolds import SPHERE_LINE, random_points
from symjax.l2e.pairs.normalised import normalise_pairs

NUM = 60


def planes_near(normal, offset, num=8, apart=0.5):
    turns = apart * jax.random.normal(jax.random.key(1), (num, 3))
    v = jnp.asarray(normal)[None] + turns
    v = v / jnp.linalg.norm(v, axis=1, keepdims=True)
    return v, offset + apart * jax.random.normal(jax.random.key(2), (num,))


@pytest.fixture(scope="module")
def pairs():
    """Centred pairs of unit size, planes near theirs, and weights."""
    p = planted_pairs(np.random.default_rng(3), NUM, 0.5, shift=0.0)
    weights = np.random.default_rng(4).uniform(0.5, 1.5, NUM)
    return jnp.asarray(p.x), jnp.asarray(p.y), jnp.asarray(weights), planes_near(p.normal, p.offset)


@jax.jit
def expanded(x, y, weights, sigma, v, omega, used):
    """Second-order expansion of ψ from the features, and its value and gradient, at several planes."""
    criterion = Criterion(features.features(x, y, weights, used=used), sigma)
    points = jnp.concatenate([v, omega[:, None]], axis=1)
    return jax.vmap(criterion.expand)(points)[1:4], jax.vmap(jax.value_and_grad(criterion.value))(points)


def test_one_product_gives_the_squared_residuals(pairs):
    x, y, _, (v, omega) = pairs
    product = 4 * jax.vmap(features.coefficients)(v, omega) @ features.feature_rows(x, y)
    expected = jax.vmap(objective.squared_residuals, (0, 0, None, None))(v, omega, x, y)
    np.testing.assert_allclose(product, expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("junk", [1e3, 1e300, np.inf, np.nan])
def test_pairs_of_weight_zero_and_padding_have_no_effect(pairs, junk):
    x, y, weights, planes = pairs
    absent = np.arange(NUM) % 3 == 0
    given = expanded(x[~absent], y[~absent], weights[~absent], 0.1, *planes, 40)
    hidden = jnp.where(absent[:, None], junk, x), jnp.where(absent[:, None], -junk, y), jnp.where(absent, 0, weights)
    same = expanded(*hidden, 0.1, *planes, NUM)
    for a, b in zip(jax.tree.leaves(same), jax.tree.leaves(given), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-13)


def test_padding_of_zero_weight_may_lie_on_the_plane(pairs):
    """A pair that fits infinitely better than all others must not set the largest exponent."""
    x, y, weights, planes = pairs
    v, omega = planes[0], planes[1] + 30
    foot = jnp.broadcast_to(v[:1] * omega[0], (4, 3))
    padded = jnp.concatenate([x, foot]), jnp.concatenate([y, foot]), jnp.append(weights, jnp.zeros(4))
    given, same = (expanded(*a, 0.01, v[:1], omega[:1], NUM) for a in ((x, y, weights), padded))
    for a, b in zip(jax.tree.leaves(same), jax.tree.leaves(given), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12)


@pytest.fixture(scope="module")
def many():
    p = planted_pairs(np.random.default_rng(5), 3000, 0.5, shift=0.0)
    weights = np.random.default_rng(6).uniform(0.5, 1.5, 3000)
    return jnp.asarray(p.x), jnp.asarray(p.y), jnp.asarray(weights), planes_near(p.normal, p.offset, 3)


@pytest.mark.parametrize("sigma", [0.02, 0.3])
def test_many_tiles_are_one_sum(many, sigma):
    x, y, weights, (v, omega) = many

    def literal(point):
        return objective.scaled_log_loss(point[:3], point[3], sigma, x, y, weights=weights)

    points = jnp.concatenate([v, omega[:, None]], axis=1)
    expected = jax.jit(jax.vmap(jax.value_and_grad(literal)))(points)
    zeros = ((0, 4096 - 3000), (0, 0))
    padded = jnp.pad(x, zeros), jnp.pad(y, zeros), jnp.pad(weights, zeros[0])
    # padding last, as the pairs are given, and padding first
    for order, used in ((slice(None), 3000), (slice(None, None, -1), 4096)):
        (value, *_), (same, gradient) = expanded(*(a[order] for a in padded), sigma, v, omega, used)
        np.testing.assert_allclose(value, expected[0], rtol=1e-12)
        np.testing.assert_allclose(same, expected[0], rtol=1e-12)
        tangent = jax.vmap(SPHERE_LINE.project)
        np.testing.assert_allclose(tangent(points, gradient), tangent(points, expected[1]), atol=1e-11)


def test_float32_keeps_its_digits_at_a_small_scale():
    """At σ = 0.005 the weights from a float32 product are wrong by a few per cent; these sums must not be."""
    sigma = 0.005
    p = planted_pairs(np.random.default_rng(7), 1000, 0.3, noise=sigma)
    x, y, weights, to_given = normalise_pairs(jnp.asarray(p.x), jnp.asarray(p.y), jnp.ones(1000))
    assert 0.3 < to_given.scale < 1
    v, omega = planes_near(p.normal, 0.0, 4, apart=1e-3)
    omega = omega + jnp.median(((x + y) / 2)[p.inlier] @ p.normal)
    sums = {}
    for dtype in (jnp.float32, jnp.float64):
        cast = partial(jnp.asarray, dtype=dtype)
        sums[dtype] = expanded(*map(cast, (x, y, weights, sigma, v, omega)), 1000)
        assert all(leaf.dtype == dtype for leaf in jax.tree.leaves(sums[dtype]))
    (value, gradient, hessian), (same, _) = sums[jnp.float32]
    (expected, *exact), _ = sums[jnp.float64]

    def log_weight(psi):
        return 1 - np.asarray(psi, float) / sigma**2

    for found in (value, same):
        np.testing.assert_allclose(log_weight(found), log_weight(expected), atol=2e-5)
    np.testing.assert_allclose(gradient, exact[0], atol=1e-3 * np.abs(exact[0]).max())
    # the Hessian is a difference of moments of the features. An error of some per cent costs steps but moves no optimum
    np.testing.assert_allclose(hessian, exact[1], atol=0.1 * np.abs(exact[1]).max())
    # for comparison: the same product in float32 is inaccurate
    product = jax.vmap(features.coefficients)(v, omega).astype(jnp.float32) @ features.feature_rows(
        x.astype(jnp.float32), y.astype(jnp.float32)
    )
    naive = np.asarray(jnp.log(jnp.mean(jnp.exp(-2 * product / sigma**2), axis=1)), float)
    assert np.abs(naive - log_weight(expected)).max() > 2e-4


@pytest.mark.any_precision
def test_features_follow_any_direction_of_the_plane(pairs):
    """The coefficients are even: (v, ω) and (−v, −ω) are one plane."""
    x, y, _, _ = pairs
    v = random_points(jax.random.key(8), 5)
    for sign in (1, -1):
        theta = jax.vmap(features.coefficients)(sign * v, sign * jnp.arange(5.0))
        np.testing.assert_array_equal(theta, jax.vmap(features.coefficients)(v, jnp.arange(5.0)))
    assert theta.shape == (5, len(features.feature_rows(x, y)))
