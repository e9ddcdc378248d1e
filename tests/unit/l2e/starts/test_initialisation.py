import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import deviation_angle
from symjax.l2e.starts.initialisation import (
    grassmann_average,
    l2_plane,
    median_point,
    pca_normal,
    rga_normal,
    weighted_quantile,
)

TRUTH = np.array([0.6, 0.0, 0.8])
ORTHOGONAL = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]


def line_with_outliers(rng, outliers):
    u = np.outer(rng.normal(size=200), TRUTH) + 0.01 * rng.normal(size=(200, 3))
    u[:outliers] += [0.0, 3.0, 0.0] * np.sign(u[:outliers] @ TRUTH)[:, None]
    return u


def test_quantiles_of_repeated_values(rng):
    values, counts = rng.normal(size=50), np.arange(50) % 4
    shares = np.array([0.1, 0.5, 0.9])
    found = weighted_quantile(jnp.asarray(values), jnp.asarray(shares), jnp.asarray(counts, float))
    np.testing.assert_array_equal(found, np.quantile(np.repeat(values, counts), shares, method="inverted_cdf"))


def test_median_point_ignores_far_points_and_weight_zero(rng):
    points = rng.normal(size=(51, 3))
    weights = np.ones(51)
    expected = np.median(points, axis=0)
    np.testing.assert_allclose(median_point(jnp.asarray(points), jnp.asarray(weights)), expected)
    padded = np.concatenate([points, np.full((40, 3), 1e9)])
    zeros = np.concatenate([weights, np.zeros(40)])
    np.testing.assert_allclose(median_point(jnp.asarray(padded), jnp.asarray(zeros)), expected)


def average_by_hand(u):
    """The plain average, straight from its definition."""
    q = np.linalg.eigh(u.T @ u)[1][:, 2]
    for _ in range(100):
        q = np.where(u @ q < 0, -1, 1) @ u
        q /= np.linalg.norm(q)
    return q


def test_plain_average_is_the_fixed_point_of_its_definition(rng):
    u = rng.normal(size=(100, 3)) * [3, 1, 0.5]
    assert deviation_angle(grassmann_average(jnp.asarray(u)), average_by_hand(u)) < 1e-9


@pytest.mark.any_precision
def test_trimming_resists_outliers_that_turn_the_plain_average(rng):
    # few and long enough to shift a mean, not enough to become the principal direction
    u = line_with_outliers(rng, 10)
    average = jax.jit(grassmann_average, static_argnames="trim")
    plain, trimmed = (deviation_angle(average(jnp.asarray(u), trim=t), TRUTH) for t in (0.0, 0.25))
    assert trimmed < 1
    assert plain > 5 * trimmed


@pytest.mark.parametrize("trim", [0.0, 0.25])
def test_average_turns_with_its_data(rng, trim):
    u = rng.normal(size=(100, 3)) * [3, 1, 0.5]
    average = jax.jit(lambda u: grassmann_average(u, trim=trim))
    turned = average(jnp.asarray(u @ ORTHOGONAL.T))
    assert deviation_angle(turned, ORTHOGONAL @ np.asarray(average(jnp.asarray(u)))) < 1e-6


@pytest.mark.parametrize("start", [rga_normal, pca_normal])
def test_starts_are_centred_and_ignore_weight_zero(start):
    p = planted_pairs(np.random.default_rng(0), 200, 0.0, "thin", shift=10.0)
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    start = jax.jit(start)
    junk = jax.random.normal(jax.random.key(0), (2, 56, 3)) * 100
    weights = jnp.append(jnp.ones(200), jnp.zeros(56))
    padded = start(jnp.concatenate([x, junk[0]]), jnp.concatenate([y, junk[1]]), weights=weights)
    assert deviation_angle(padded, p.normal) < 1


def test_l2_plane_minimises_the_squares(rng):
    p = planted_pairs(rng, 50, 0.3, noise=0.05)
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    plane = jax.jit(l2_plane)(x, y)

    def squares(normal, offset):
        normal = normal / jnp.linalg.norm(normal)
        image = x - 2 * ((x * normal[None, :]).sum(1) - offset)[:, None] * normal[None, :]
        return jnp.sum((y - image) ** 2)

    value, (slope_v, slope_omega) = jax.jit(jax.value_and_grad(squares, argnums=(0, 1)))(*plane)
    assert jnp.linalg.norm(slope_v) < 1e-11 * value
    assert abs(slope_omega) < 1e-11 * value


def test_printed_h_is_right_only_where_the_mid_points_have_mean_zero():
    p = planted_pairs(np.random.default_rng(2), 200, 0.0, shift=0.3)
    mean = (p.x + p.y).mean(axis=0) / 2
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    assert l2_plane(x, y).angle(l2_plane(x, y, as_printed=True)) > 5
    assert deviation_angle(l2_plane(x, y).normal, p.normal) < 0.2
    centred = l2_plane(x - mean[None, :], y - mean[None, :], as_printed=True)
    assert deviation_angle(centred.normal, p.normal) < 0.2


def test_l2_weights_are_repetitions(rng):
    p = planted_pairs(rng, 30, 0.3)
    counts = np.arange(30) % 3
    baseline = jax.jit(l2_plane)
    weighted = baseline(jnp.asarray(p.x), jnp.asarray(p.y), jnp.asarray(counts, float))
    repeated = baseline(jnp.repeat(jnp.asarray(p.x), counts, axis=0), jnp.repeat(jnp.asarray(p.y), counts, axis=0))
    np.testing.assert_allclose(weighted.normal, repeated.normal, atol=1e-12)
    np.testing.assert_allclose(weighted.offset, repeated.offset, atol=1e-12)
