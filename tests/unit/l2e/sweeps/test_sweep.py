"""Sweeps: named starts, the order of scales and starts, and invalid arguments."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError
from symjax.geometry.directions import deviation_angle, fibonacci
from symjax.l2e import sweep as sweep_module
from symjax.l2e.fit import best
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.manifolds import random_points
from symjax.l2e.starts.initialisation import NORMALS
from symjax.l2e.sweep import sweep

NUM, SIGMAS, RESTARTS = 200, [0.05, 0.02, 0.2], 10


@pytest.fixture(scope="module")
def pairs():
    return planted_pairs(np.random.default_rng(41), NUM, 0.7)


def swept(pairs, v0s, **options):
    return sweep(pairs.x, pairs.y, SIGMAS, v0s, restarts=RESTARTS, **options)


@pytest.fixture(scope="module")
def even(pairs):
    return swept(pairs, "fibonacci")


def assert_same(found, expected):
    for a, b in zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)


def test_even_and_random_starts_are_those_of_the_sphere(pairs, even):
    assert_same(even, swept(pairs, fibonacci(RESTARTS)))
    key = jax.random.key(3)
    found = swept(pairs, "random", key=key)
    assert_same(found, swept(pairs, random_points(key, RESTARTS)))
    assert not np.allclose(found.num_steps, swept(pairs, "random", key=jax.random.key(4)).num_steps)


@pytest.mark.slow
@pytest.mark.parametrize("name", NORMALS)
def test_a_start_that_is_one_normal_is_that_normal(pairs, name):
    """It is a single start, regardless of `restarts`."""
    normal = NORMALS[name](jnp.asarray(pairs.x), jnp.asarray(pairs.y))
    found, given = swept(pairs, name), swept(pairs, normal[None])
    assert found.loss.shape == given.loss.shape == (3, 1)
    np.testing.assert_allclose(found.plane.normal, given.plane.normal, atol=1e-7)
    np.testing.assert_allclose(found.loss, given.loss, rtol=1e-7)


def test_hypotheses_are_the_default_and_one_of_them_is_right(pairs):
    found = sweep(pairs.x, pairs.y, SIGMAS, restarts=RESTARTS)
    assert found.loss.shape == (3, RESTARTS)
    assert (deviation_angle(found.plane.normal[:2, 0], pairs.normal[None]) < 1).all()  # the best is the first
    loss = np.asarray(best(found).loss)
    np.testing.assert_allclose(loss[:2], best(swept(pairs, fibonacci(RESTARTS))).loss[:2], rtol=1e-9)
    np.testing.assert_allclose(loss[:2], found.loss[:2, 0], rtol=1e-9)


def test_every_sigma_stays_in_its_place(pairs, even):
    np.testing.assert_allclose(even.sigma, np.tile(np.array(SIGMAS)[:, None], RESTARTS), rtol=1e-12)
    assert not even.sigma_estimated.any()
    order = [2, 0, 1]
    turned = sweep(pairs.x, pairs.y, np.array(SIGMAS)[order], "fibonacci", restarts=RESTARTS)
    assert_same(turned, jax.tree.map(lambda leaf: leaf[np.array(order)], even))
    again = sweep(pairs.x, pairs.y, [0.05, 0.05, 0.05], "fibonacci", restarts=RESTARTS)
    for row in range(3):
        assert_same(jax.tree.map(lambda leaf, row=row: leaf[row], again), jax.tree.map(lambda leaf: leaf[0], even))


def test_each_is_a_fit_from_its_start(pairs, even):
    v0s = fibonacci(RESTARTS)
    for s, r in ((0, 0), (1, 4), (2, 9)):
        alone = fit_plane(pairs.x, pairs.y, SIGMAS[s], v0s[r])
        np.testing.assert_allclose(even.plane.normal[s, r], alone.plane.normal, atol=1e-8)
        np.testing.assert_allclose(even.loss[s, r], alone.loss, rtol=1e-9)
        np.testing.assert_allclose(even.inlier_fraction[s, r], alone.inlier_fraction, rtol=1e-8)
        assert even.message[s, r] == alone.message


def test_weights_and_limits_reach_every_fit(pairs, even):
    weights = np.ones(NUM)
    assert_same(swept(pairs, "fibonacci", weights=7 * weights), even)
    weights[::2] = 0
    x = np.where(weights[:, None] > 0, pairs.x, 1e6)
    thinned = sweep(x, pairs.y, SIGMAS, "fibonacci", restarts=RESTARTS, weights=weights)
    assert np.isfinite(thinned.loss).all()
    assert not np.allclose(thinned.loss, even.loss, rtol=1e-3)
    short = swept(pairs, "fibonacci", max_steps=1)
    assert short.num_steps.max() == 1
    loose = swept(pairs, "fibonacci", tol=1e-3)
    assert loose.grad_norm.max() <= 1e-3
    assert loose.num_steps.sum() < even.num_steps.sum()


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"v0s": "random"}, "takes a key"),
        ({"v0s": "fibonacci", "key": jax.random.key(0)}, "no other start takes one"),
        ({"key": jax.random.key(0)}, "no other start takes one"),
        ({"v0s": "corners"}, "'corners' is unknown: choose one of fibonacci, hypotheses, random, rga, pca, l2"),
        ({"restarts": 0}, "restarts must be a whole number, at least 1, got 0"),
        ({"v0s": np.zeros((2, 3))}, "2 of 2 starting normals"),
        ({"sigmas": "auto"}, "sigmas"),
        ({"sigmas": [0.1, -0.1]}, "sigmas must be positive"),
        ({"sigmas": []}, r"sigmas must have shape \(S,\), got \(0,\)"),
        ({"solver": "simplex"}, "'simplex' is unknown"),
        ({"max_steps": -3}, "max_steps"),
    ],
)
def test_bad_sweeps_are_refused_before_anything_is_computed(monkeypatch, options, match):
    monkeypatch.setattr(sweep_module, "_sweep", None)
    with pytest.raises(InvalidArgumentError, match=match):
        sweep(**{"x": np.eye(3), "y": np.eye(3)[::-1], "sigmas": [0.1]} | options)
