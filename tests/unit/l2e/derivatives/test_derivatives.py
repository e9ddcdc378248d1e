"""Derivatives of fits by the implicit function theorem, through the public functions."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.fit import best
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.sweep import sweep


@pytest.fixture(scope="module")
def smooth():
    p = planted_pairs(np.random.default_rng(5), 30, 0.4, noise=0.03)
    w = np.random.default_rng(6).uniform(0.5, 1.5, 30)
    return tuple(map(jnp.asarray, (p.x, p.y, np.float64(0.1), w)))


def outputs(v0, x, y, sigma, weights, solver="newton"):
    fit = fit_plane(x, y, sigma, v0, weights=weights, solver=solver)
    return jnp.concatenate([fit.plane.normal, fit.plane.offset[None], fit.loss[None]])


@pytest.fixture(scope="module")
def v0(smooth):
    x, y, sigma, weights = smooth
    return fit_plane(x, y, sigma, weights=weights).plane.normal


@pytest.fixture(scope="module")
def answer(v0):
    return jax.jit(partial(outputs, v0))


@pytest.fixture(scope="module")
def tangents(smooth):
    key = jax.random.split(jax.random.key(0), 4)
    return tuple(jax.random.normal(k, a.shape) * jnp.mean(jnp.abs(a)) for k, a in zip(key, smooth, strict=True))


def central_difference(answer, values, tangent, step=1e-5):
    high, low = (answer(*(a + s * t for a, t in zip(values, tangent, strict=True))) for s in (step, -step))
    return np.asarray((high - low) / (2 * step))


def assert_close(derivative, expected, relative):
    """The tolerance is relative to each entry, or to the norm of the plane's derivative if that is larger."""
    scale = np.maximum(np.abs(expected), np.linalg.norm(expected[:4]))
    assert (np.abs(derivative - expected) <= relative * scale).all()


def test_derivatives_are_those_of_central_differences(smooth, tangents, answer):
    forward = jax.jit(lambda *t: jax.jvp(answer, smooth, t)[1])
    reverse = jax.jit(jax.jacrev(answer, argnums=(0, 1, 2, 3)))(*smooth)
    for k in range(4):  # x, y, sigma and weights one at a time
        tangent = tuple(t if k == j else jnp.zeros_like(t) for j, t in enumerate(tangents))
        by_jvp = forward(*tangent)
        assert_close(by_jvp, central_difference(answer, smooth, tangent), 1e-6)
        by_vjp = jnp.sum(reverse[k] * tangent[k][None], axis=tuple(range(1, reverse[k].ndim)))
        np.testing.assert_allclose(by_vjp, by_jvp, atol=1e-10 * np.abs(by_jvp).max())


@pytest.mark.slow
@pytest.mark.parametrize(("solver", "relative"), [("irls", 1e-6), ("rbfgs", 1e-6), ("alternating", 1e-5)])
def test_every_solver_has_the_derivatives_of_newton(smooth, tangents, v0, answer, solver, relative):
    """They are evaluated at the solver's own optimum, which is as accurate as its tolerance."""
    compiled = jax.jit(lambda values, tangents: jax.jvp(partial(outputs, v0, solver=solver), values, tangents))
    out, derivative = compiled(smooth, tangents)
    np.testing.assert_allclose(out, answer(*smooth), rtol=relative, atol=1e-7)
    assert_close(derivative, central_difference(answer, smooth, tangents), relative)


@pytest.mark.slow
def test_derivatives_ignore_the_start_and_its_sign(smooth, v0):
    x, y, sigma, weights = smooth
    slope = jax.jit(jax.grad(lambda x, v0: fit_plane(x, y, sigma, v0, weights=weights).plane.offset, argnums=(0, 1)))
    by_x, by_start = slope(x, v0)
    np.testing.assert_array_equal(by_start, 0)
    np.testing.assert_allclose(slope(x, -v0)[0], by_x, atol=1e-9)
    assert jnp.abs(by_x).max() > 0


@pytest.mark.slow
def test_gradients_go_through_vmap_and_sweeps(smooth, v0):
    x, y, sigma, weights = smooth

    def offset(x, v0):
        return fit_plane(x, y, sigma, v0, weights=weights).plane.offset

    alone = jax.jit(jax.grad(offset))
    xs = jnp.stack([x, x + 0.01, x * 1.01])
    together = jax.jit(jax.vmap(jax.grad(offset), (0, None)))(xs, v0)
    for k in range(3):
        np.testing.assert_allclose(together[k], alone(xs[k], v0), atol=1e-9)

    @jax.jit
    @jax.grad
    def swept(x):
        return best(sweep(x, y, sigma[None], v0[None], weights=weights)).plane.offset[0]

    np.testing.assert_allclose(swept(x), alone(x, v0), atol=1e-9)
