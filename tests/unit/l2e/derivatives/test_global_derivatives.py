"""`fit_global` has the derivatives of `fit_plane` started at its result: forward, reverse, under vmap and jit."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.fit_global import fit_global
from symjax.l2e.fit_plane import fit_plane

pytestmark = pytest.mark.slow

NUM, SIGMA = 250, 0.03
# below the default, so that differences of fits are accurate
TOL = 1e-12


@pytest.fixture(scope="module")
def pairs():
    return planted_pairs(np.random.default_rng(31), NUM, 0.8)


def outputs(fit):
    return jnp.concatenate([fit.plane.normal, fit.plane.offset[None], fit.loss[None], fit.inlier_fraction[None]])


@pytest.fixture(scope="module")
def smooth(pairs):
    """All arguments that a fit is differentiable in, with tangents, and a cotangent of the outputs."""
    rng = np.random.default_rng(5)
    weights = rng.uniform(0.5, 1.5, NUM)
    values = tuple(map(jnp.asarray, (pairs.x, pairs.y, np.float64(SIGMA), weights)))
    tangents = tuple(jnp.asarray(rng.normal(size=a.shape) * float(jnp.mean(jnp.abs(a)))) for a in values)
    return values, tangents, jnp.asarray(rng.normal(size=6) * [1, 1, 1, 1, 1e-3, 1])


def derivatives(answer):
    """A compiled function that returns the outputs at the values, their forward derivative, and the pull-back."""

    @jax.jit
    def compiled(values, tangents, cotangent):
        out, push = jax.linearize(answer, *values)
        return out, push(*tangents), jax.linear_transpose(push, *values)(cotangent)

    return compiled


@pytest.fixture(scope="module")
def by_global():
    return derivatives(lambda x, y, sigma, weights: outputs(fit_global(x, y, sigma, weights=weights, tol=TOL)))


def test_derivatives_are_those_of_fit_plane_started_at_the_result(smooth, by_global):
    values, tangents, cotangent = smooth
    out, forward, reverse = by_global(*smooth)
    by_plane = derivatives(
        lambda x, y, sigma, weights, v0: outputs(fit_plane(x, y, sigma, v0, weights=weights, tol=TOL)),
    )
    for v0 in (out[:3], -out[:3]):
        same, forward_there, (*reverse_there, by_start) = by_plane((*values, v0), (*tangents, jnp.ones(3)), cotangent)
        np.testing.assert_allclose(out, same, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(forward, forward_there, rtol=1e-7, atol=1e-9)
        for a, b in zip(reverse, reverse_there, strict=True):
            np.testing.assert_allclose(a, b, atol=1e-8 * np.abs(b).max())
        np.testing.assert_array_equal(by_start, 0)


def test_derivatives_are_those_of_central_differences(smooth, by_global):
    values, tangents, cotangent = smooth
    _, forward, reverse = by_global(*smooth)
    pulled = sum(jnp.sum(a * t) for a, t in zip(reverse, tangents, strict=True))
    np.testing.assert_allclose(pulled, forward @ cotangent, rtol=1e-9)
    step = 1e-5
    moved = (tuple(a + s * t for a, t in zip(values, tangents, strict=True)) for s in (step, -step))
    high, low = (by_global(there, tangents, cotangent)[0] for there in moved)
    np.testing.assert_allclose((high - low) / (2 * step), forward, rtol=1e-6, atol=1e-7)


@pytest.mark.slow
def test_clouds_go_through_vmap_and_jit(smooth, by_global):
    """The gradient of every cloud in the batch is its own."""
    clouds = [planted_pairs(np.random.default_rng(seed), NUM, 0.8) for seed in (31, 32)]
    xs, ys = (jnp.stack([jnp.asarray(getattr(p, end)) for p in clouds]) for end in "xy")

    def offset(x, y):
        fit = fit_global(x, y, SIGMA)
        return fit.plane.offset, fit

    (_, fits), slopes = jax.jit(jax.vmap(jax.value_and_grad(offset, has_aux=True)))(xs, ys)
    values, tangents, _ = smooth
    of_the_offset = jnp.zeros(6).at[3].set(1)
    for k in range(2):
        _, _, (slope, *_) = by_global((xs[k], ys[k], values[2], jnp.ones(NUM)), tangents, of_the_offset)
        fit = fit_global(xs[k], ys[k], SIGMA)
        np.testing.assert_allclose(slopes[k], slope, atol=1e-8 * np.abs(slope).max())
        assert fit.converged
        np.testing.assert_allclose(fits.plane.normal[k], fit.plane.normal, atol=1e-9)
        np.testing.assert_allclose(fits.plane.offset[k], fit.plane.offset, atol=1e-9)
        np.testing.assert_allclose(fits.loss[k], fit.loss, rtol=1e-9)
