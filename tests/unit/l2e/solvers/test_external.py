"""Optimistix minimisers reach the optimum of our own solvers, with the same derivatives."""

import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError
from symjax.geometry.directions import fibonacci
from symjax.l2e.fit import best
from symjax.l2e.fit_plane import _fit_plane, fit_plane
from symjax.l2e.sweep import sweep

SIGMA, NUM = 0.05, 60
BFGS = optx.BFGS(rtol=1e-8, atol=1e-8)


@pytest.fixture(scope="module")
def pairs():
    return planted_pairs(np.random.default_rng(0), NUM, 0.3)


def same(fit, expected, atol=1e-6):
    np.testing.assert_allclose(fit.plane.normal, expected.plane.normal, atol=atol)
    np.testing.assert_allclose(fit.plane.offset, expected.plane.offset, atol=atol)
    np.testing.assert_allclose(fit.loss, expected.loss, rtol=1e-9)


@pytest.mark.slow
def test_the_best_of_many_starts_is_that_of_our_solvers(pairs):
    starts = fibonacci(40)
    found = sweep(pairs.x, pairs.y, [SIGMA, 0.2], starts, solver=BFGS)
    assert np.mean(found.converged) > 0.9
    for solver in ("newton", "rbfgs"):
        same(best(found), best(sweep(pairs.x, pairs.y, [SIGMA, 0.2], starts, solver=solver)))


def test_a_start_in_the_other_half_sphere_converges():
    """At a large σ there is one basin. From more than 90 degrees away no single chart contains the optimum."""
    p = planted_pairs(np.random.default_rng(1), NUM, 0.0, "wide", noise=0.01)
    across = np.linalg.svd(p.normal[None])[2][1]
    for angle in (95, 120, 150):
        v0 = np.cos(np.radians(angle)) * p.normal + np.sin(np.radians(angle)) * across
        fit = fit_plane(p.x, p.y, 1.0, v0, solver=BFGS)
        assert fit.converged
        same(fit, fit_plane(p.x, p.y, 1.0, p.normal))


def test_another_minimiser_works_too(pairs):
    fit = fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal, solver=optx.NonlinearCG(rtol=1e-8, atol=1e-8))
    assert fit.converged
    same(fit, fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal))


@pytest.mark.slow
def test_convergence_is_judged_by_our_own_tolerance(pairs):
    """A minimiser with loose tolerances continues in further charts until the gradient is within tol."""
    fit = fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal, solver=optx.BFGS(rtol=0.1, atol=0.1))
    assert fit.converged
    assert fit.grad_norm <= np.finfo(float).eps ** 0.4
    assert fit.num_steps > 1
    short = fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal, solver=BFGS, max_steps=0)
    assert not short.converged
    assert "max_steps was reached" in short.message


@pytest.mark.slow
def test_jit_vmap_and_grad_apply_to_it(pairs):
    v0 = jnp.asarray(pairs.normal)

    def offset(x, y, sigma, solver):
        return fit_plane(x, y, sigma, v0, solver=solver, tol=1e-8).plane.offset

    moved = jnp.stack([jnp.asarray(pairs.x), jnp.asarray(pairs.x) + 0.01])
    y = jnp.asarray(pairs.y)
    slopes = {}
    for solver in (BFGS, "newton"):
        run = jax.jit(jax.vmap(jax.value_and_grad(lambda x, solver=solver: offset(x, y, SIGMA, solver))))
        slopes[solver] = run(moved)
    for a, b in zip(slopes[BFGS], slopes["newton"], strict=True):
        np.testing.assert_allclose(a, b, atol=1e-6 * np.abs(b).max())


def test_minimisers_of_equal_options_are_compiled_once(pairs):
    fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal, solver=BFGS)
    compiled = _fit_plane._cache_size()
    fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal, solver=optx.BFGS(rtol=1e-8, atol=1e-8))
    assert _fit_plane._cache_size() == compiled


def test_optimistix_is_imported_when_it_is_used():
    program = "import sys; import symjax.l2e.fit_plane, symjax.l2e.sweep; assert 'optimistix' not in sys.modules"
    subprocess.run([sys.executable, "-c", program], check=True)


def test_invalid_solvers_are_refused(pairs):
    with pytest.raises(InvalidArgumentError, match="pass them as numbers, not as arrays"):
        fit_plane(pairs.x, pairs.y, SIGMA, solver=optx.BFGS(rtol=jnp.asarray(1e-8), atol=1e-8))
    with pytest.raises(InvalidArgumentError, match="neither a name nor an optimistix minimiser"):
        fit_plane(pairs.x, pairs.y, SIGMA, solver=optx.Newton(rtol=1e-8, atol=1e-8))
    with pytest.raises(InvalidArgumentError, match="estimated with solver='newton'"):
        fit_plane(pairs.x, pairs.y, "auto", solver=BFGS)
