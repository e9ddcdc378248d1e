"""The derivatives of the estimated σ and inlier fraction are correct."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.fit_plane import fit_plane

pytestmark = pytest.mark.slow

NUM = 250
NAMES = ("normal x", "normal y", "normal z", "offset", "loss", "sigma", "inlier fraction")


@pytest.fixture(scope="module")
def values():
    p = planted_pairs(np.random.default_rng(61), NUM, 0.4, noise=0.03)
    weights = np.random.default_rng(62).uniform(0.5, 1.5, NUM)
    return tuple(map(jnp.asarray, (p.x, p.y, weights, p.normal)))


@jax.jit
def derivatives(values, tangents, cotangent):
    """Returns the outputs, their forward derivative, and the pull-back."""

    def answer(x, y, weights, v0):
        # below the default tolerance, so that differences of fits are accurate
        fit = fit_plane(x, y, "auto", v0, weights=weights, tol=1e-12)
        rest = jnp.stack([fit.plane.offset, fit.loss, fit.sigma, fit.inlier_fraction])
        return jnp.concatenate([fit.plane.normal, rest])

    out, push = jax.linearize(answer, *values)
    return out, push(*tangents), jax.linear_transpose(push, *values)(cotangent)


def moved(values, tangents, step):
    there = tuple(a + step * t for a, t in zip(values, tangents, strict=True))
    return derivatives(there, tangents, jnp.ones(7))[0]


def test_the_planted_scale_and_inlier_fraction_are_found(values):
    out, *_ = derivatives(values, values, jnp.ones(7))
    np.testing.assert_allclose(out[5], 0.03, rtol=0.15)
    np.testing.assert_allclose(out[6], 0.6, atol=0.1)


@pytest.mark.parametrize("which", [0, 1, 2], ids=["x", "y", "weights"])
def test_derivatives_are_those_of_central_differences(values, which):
    direction = np.random.default_rng(which).normal(size=values[which].shape)
    tangents = tuple(jnp.asarray(direction) if k == which else jnp.zeros_like(a) for k, a in enumerate(values))
    _, forward, _ = derivatives(values, tangents, jnp.ones(7))
    assert np.abs(forward).min() > 0
    step = 2e-5
    at = {k: moved(values, tangents, k * step) for k in (-2, -1, 1, 2)}
    central = (8 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12 * step)  # of fourth order
    scale = np.maximum(np.abs(forward), np.linalg.norm(forward[:4]))
    for name, error in zip(NAMES, np.abs(central - forward) / scale, strict=True):
        assert error <= 1e-6, name


def test_reverse_is_the_transpose_of_forward_and_ignores_the_start(values):
    rng = np.random.default_rng(5)
    tangents = tuple(jnp.asarray(rng.normal(size=a.shape)) for a in values)
    cotangent = jnp.asarray(rng.normal(size=7))
    _, forward, reverse = derivatives(values, tangents, cotangent)
    pulled = sum(jnp.sum(a * t) for a, t in zip(reverse, tangents, strict=True))
    np.testing.assert_allclose(pulled, forward @ cotangent, rtol=1e-9)
    np.testing.assert_array_equal(reverse[3], 0)
    opposite = derivatives((*values[:3], -values[3]), tangents, cotangent)[2]
    for a, b in zip(opposite[:3], reverse[:3], strict=True):
        np.testing.assert_allclose(a, b, atol=1e-8 * np.abs(b).max())


def test_scale_is_homogeneous_in_the_points_and_the_inlier_fraction_is_invariant(values):
    """Euler's theorem: the derivative along the points is σ for σ and −3 times the loss; along the weights it is 0."""
    x, y, weights, _ = values
    zero = jnp.zeros_like
    out, by_points, _ = derivatives(values, (x, y, zero(weights), jnp.zeros(3)), jnp.ones(7))
    np.testing.assert_allclose(by_points[3], out[3], rtol=1e-8)
    np.testing.assert_allclose(by_points[4], -3 * out[4], rtol=1e-8)
    np.testing.assert_allclose(by_points[5], out[5], rtol=1e-8)
    np.testing.assert_allclose([*by_points[:3], by_points[6]], 0, atol=1e-8)
    _, by_weights, _ = derivatives(values, (zero(x), zero(y), weights, jnp.zeros(3)), jnp.ones(7))
    np.testing.assert_allclose(by_weights / out, 0, atol=1e-8)
