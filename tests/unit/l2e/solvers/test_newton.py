"""Trust-region Newton: few steps to the optimum of the other solvers, from any start, and its final status."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.criterion import Criterion
from symjax.l2e.features import features
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.manifolds import random_points
from symjax.l2e.solvers.base import Limits, solve
from symjax.l2e.solvers.registry import SOLVERS
from symjax.l2e.status import Status

NUM, NUM_STARTS, TOL = 1000, 32, 1e-8

# the inner solver of the alternation sees no decrease below a gradient of about 1e-7
REACHED = {"newton": TOL, "irls": TOL, "rbfgs": TOL, "alternating": 1e-6}


def solved(x, y, sigma, starts, tol=TOL, max_steps=200, name="newton"):
    """The minima from several starts, and the curvatures there."""
    return compiled(x, y, sigma, starts, tol, max_steps, name)  # always all arguments: one program


@partial(jax.jit, static_argnums=6)
def compiled(x, y, sigma, starts, tol, max_steps, name):
    criterion = Criterion(features(x, y), sigma)
    found = jax.vmap(partial(solve, SOLVERS[name](criterion, Limits(max_steps, tol))))(starts)
    curvatures = jnp.linalg.eigvalsh(jax.vmap(criterion.expand)(found.point).hessian)
    return found, curvatures


def ended(found, how):
    return (found.status == how).all()


def planted(seed, outliers):
    """Pairs about the origin and of unit radius, as the solvers take them."""
    p = planted_pairs(np.random.default_rng(seed), NUM, outliers, shift=0.0)
    return p, jnp.asarray(p.x), jnp.asarray(p.y)


def near(p, seed=0, angle=0.15):
    """Starts within `angle` radians of the planted normal, and within `angle` radii of its offset."""
    rng = np.random.default_rng(seed)
    across = np.cross(p.normal, rng.normal(size=(NUM_STARTS, 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    turn = angle * rng.random((NUM_STARTS, 1))
    v = np.cos(turn) * p.normal + np.sin(turn) * across
    return jnp.asarray(np.concatenate([v, p.offset + angle * rng.uniform(-1, 1, (NUM_STARTS, 1))], axis=1))


def anywhere(p, seed):
    """Random normals, through the mid-points of random pairs."""
    v = random_points(jax.random.key(seed), NUM_STARTS)
    row = np.random.default_rng(seed).integers(0, NUM, NUM_STARTS)
    return jnp.concatenate([v, jnp.sum(v * 0.5 * (p.x + p.y)[row], axis=1)[:, None]], axis=1)


@pytest.fixture(scope="module")
def half():
    return planted(0, 0.5)


@pytest.mark.parametrize("name", SOLVERS)
def test_every_solver_reaches_the_same_optimum(half, name):
    p, x, y = half
    # from farther away they may end in different optima
    starts = near(p, angle=0.08)
    expected, _ = solved(x, y, 0.05, starts, tol=1e-12)
    found, _ = solved(x, y, 0.05, starts, tol=REACHED[name], name=name)
    assert ended(found, Status.SUCCESSFUL)
    assert (found.grad_norm <= REACHED[name]).all()
    np.testing.assert_allclose(found.point, expected.point, atol=5 * REACHED[name])
    np.testing.assert_allclose(found.value, expected.value, atol=1e-12)


@pytest.mark.parametrize("sigma", [0.02, 0.05, 0.2])
def test_few_steps_from_local_starts(sigma):
    steps = []
    for seed in range(3):
        p, x, y = planted(seed, 0.5)
        found, _ = solved(x, y, sigma, near(p, seed))
        assert ended(found, Status.SUCCESSFUL)
        steps.append(found.num_steps)
    assert np.median(steps) <= 6


@pytest.mark.parametrize("sigma", [0.02, 0.05, 0.2])
def test_few_steps_from_anywhere_to_a_minimum(sigma):
    steps = []
    for seed in range(3):
        p, x, y = planted(seed, 0.8)
        found, curvatures = solved(x, y, sigma, anywhere(p, seed))
        assert ended(found, Status.SUCCESSFUL)
        assert curvatures.min() > -1e-6  # no saddle
        steps.append(found.num_steps)
    assert np.mean(steps) <= 15


def test_psi_never_rises_from_step_to_step(half):
    p, x, y = half
    starts = anywhere(p, 1)
    values = np.stack([solved(x, y, 0.1, starts, max_steps=k)[0].value for k in range(30)])
    assert (np.diff(values, axis=0) <= 1e-14).all()
    assert (values[-1] < values[0]).all()


def test_the_tail_is_quadratic(half):
    p, x, y = half
    first, then, last = (solved(x, y, 0.05, near(p), tol=tol)[0] for tol in (1e-3, 1e-6, 1e-12))
    assert (then.num_steps - first.num_steps).max() <= 2
    assert (last.num_steps - then.num_steps).max() <= 1


@pytest.fixture(scope="module")
def box():
    """Exact pairs of a cloud with two more symmetry planes, which are saddles of the criterion."""
    corner = np.random.default_rng(3).normal(size=(NUM // 8, 3)) * [1, 0.7, 0.5]
    signs = np.stack(np.meshgrid(*3 * [[1, -1]]), axis=-1).reshape(8, 1, 3)
    x = jnp.asarray((signs * corner).reshape(-1, 3))
    return x, x * jnp.asarray([[1.0, 1.0, -1.0]])


@pytest.mark.parametrize("name", ["newton", "irls"])
@pytest.mark.parametrize("sigma", [0.1, 0.5, 2.0])
def test_solvers_escape_a_saddle_at_once(box, sigma, name):
    x, y = box
    apart = 1e-6 * np.random.default_rng(4).normal(size=(NUM_STARTS, 4))
    v = np.eye(3)[np.arange(NUM_STARTS) % 2] + apart[:, :3]
    starts = jnp.asarray(np.concatenate([v / np.linalg.norm(v, axis=1, keepdims=True), apart[:, 3:]], axis=1))
    before, curvatures = solved(x, y, sigma, starts, max_steps=0, name=name)
    assert (before.grad_norm < 1e-4).all()
    assert (curvatures.min(axis=1) < -0.1).all()
    found, curvatures = solved(x, y, sigma, starts, name=name)
    assert ended(found, Status.SUCCESSFUL)
    assert (curvatures > 0).all()
    np.testing.assert_allclose(np.abs(found.point), np.tile([0, 0, 1, 0], (NUM_STARTS, 1)), atol=1e-9)
    assert found.num_steps.max() <= 3


@pytest.mark.parametrize("name", SOLVERS)
def test_the_status_is_correct(half, name):
    p, x, y = half
    starts = near(p)
    found, _ = solved(x, y, 0.05, starts, max_steps=1, name=name)
    assert ended(found, Status.MAX_STEPS_REACHED)
    assert (found.num_steps == 1).all()
    for sigma, where in ((jnp.nan, starts), (0.05, starts.at[:, 3].set(jnp.nan))):
        assert ended(solved(x, y, sigma, where, name=name)[0], Status.NONFINITE)
    # no gradient is below a negative tolerance
    found, _ = solved(x, y, 0.05, starts, tol=-1.0, max_steps=30, name=name)
    assert not (found.status == Status.SUCCESSFUL).any()
    assert np.median(found.grad_norm) <= REACHED[name]


@pytest.mark.parametrize("name", ["newton", "irls"])
def test_a_solve_below_rounding_stalls(half, name):
    p, x, y = half
    found, _ = solved(x, y, 0.05, near(p), tol=-1.0, name=name)
    assert ended(found, Status.STALLED)
    assert found.num_steps.max() < 100


@pytest.mark.any_precision
def test_float32_converges_from_anywhere():
    p, x, y = planted(1, 0.5)
    starts = jnp.asarray(anywhere(p, 2), jnp.float32)
    found, _ = solved(x.astype(jnp.float32), y.astype(jnp.float32), jnp.float32(0.1), starts, jnp.float32(2e-5))
    assert found.point.dtype == found.value.dtype == jnp.float32
    assert ended(found, Status.SUCCESSFUL)


def test_a_plane_that_no_pair_supports_is_flat():
    """A stationary point is not a success if all pairs are hundreds of σ away from mirror pairs of the plane."""
    rng = np.random.default_rng(5)
    x = rng.normal(size=(60, 3)) * [0.0, 1.0, 0.0] + [0.0, 0.0, 1.0]
    x[:, 0] = np.linspace(-1, 1, 60)
    fit = fit_plane(x, x * [1.0, 1.0, -1.0], 0.005, np.array([1.0, 0.0, 0.0]), solver="irls")
    assert not fit.converged
    assert fit.message == Status.FLAT.sentence
    assert fit.inlier_fraction == 0
