"""ψ and its derivatives by matrix products equal those of the direct objective, alone and in batches."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e import objective
from symjax.l2e.criterion import Criterion, mm_step
from symjax.l2e.features import features
from symjax.l2e.manifolds import SPHERE_LINE, random_points, tangent_basis

NUM = 60
SIGMAS = [0.02, 0.1, 0.6]


@pytest.fixture(scope="module")
def pairs():
    p = planted_pairs(np.random.default_rng(11), NUM, 0.5, shift=0.0)
    weights = np.random.default_rng(12).uniform(0.5, 1.5, NUM)
    return jnp.asarray(p.x), jnp.asarray(p.y), jnp.asarray(weights)


@pytest.fixture(scope="module")
def planes():
    """Planes unrelated to the pairs. One of them is the pole at which the tangent basis changes."""
    v = random_points(jax.random.key(0), 64).at[0].set(jnp.asarray([0.0, 0.0, -1.0]))
    return jnp.concatenate([v, 0.4 * jax.random.normal(jax.random.key(1), (64, 1))], axis=1)


@jax.jit
def expanded(pairs, sigma, points):
    return jax.vmap(Criterion(features(*pairs), sigma).expand)(points)


def literal(pairs, sigma, z):
    x, y, weights = pairs
    return objective.scaled_log_loss(z[:3], z[3], sigma, x, y, weights=weights)


@jax.jit
def in_the_chart(pairs, sigma, points):
    """The direct ψ, its gradient and its Hessian in the tangent chart, by automatic differentiation."""

    def derivatives(z):
        basis = SPHERE_LINE.basis(z)

        def chart(t):
            return literal(pairs, sigma, SPHERE_LINE.retract(z, basis @ t))

        origin = jnp.zeros(3, z.dtype)
        return chart(origin), jax.grad(chart)(origin), jax.hessian(chart)(origin)

    return jax.vmap(derivatives)(points)


@pytest.mark.parametrize("sigma", SIGMAS)
def test_value_gradient_and_hessian_are_those_of_the_chart(pairs, planes, sigma):
    at = expanded(pairs, sigma, planes)
    value, gradient, hessian = in_the_chart(pairs, sigma, planes)
    np.testing.assert_allclose(at.value, value, rtol=1e-12)
    np.testing.assert_allclose(at.gradient, gradient, atol=1e-11)
    np.testing.assert_allclose(at.hessian, hessian, atol=1e-14 / sigma**4 + 1e-11)
    np.testing.assert_array_equal(at.point, planes)


@pytest.mark.parametrize("sigma", SIGMAS)
def test_gradient_of_the_value_is_that_of_the_objective(pairs, planes, sigma):
    values, slopes = jax.jit(
        lambda pairs, sigma, points: jax.vmap(jax.value_and_grad(Criterion(features(*pairs), sigma).value))(points)
    )(pairs, sigma, planes)
    slope = jax.jit(jax.vmap(jax.value_and_grad(literal, argnums=2), (None, None, 0)))
    expected, by_autodiff = slope(pairs, sigma, planes)
    np.testing.assert_allclose(values, expected, rtol=1e-12)
    project = jax.vmap(SPHERE_LINE.project)
    np.testing.assert_allclose(project(planes, slopes), project(planes, by_autodiff), atol=1e-11)
    at = expanded(pairs, sigma, planes)
    basis = jax.vmap(SPHERE_LINE.basis)(planes)
    np.testing.assert_allclose(jnp.einsum("pdk,pd->pk", basis, slopes), at.gradient, atol=1e-11)


def test_gradient_is_the_closed_form_of_the_paper(pairs, planes):
    """∇ψ = −σ² ∇f/f of the f of Eq. 5: its closed gradients (Eqs. 6 and 7), projected."""
    x, y, _ = pairs
    sigma = 0.3
    at = expanded((x, y, jnp.ones(NUM)), sigma, planes)
    for k in range(0, 64, 7):
        v, omega = planes[k, :3], planes[k, 3]
        grad_v, grad_omega = objective.l2e_gradients(v, omega, sigma, x, y)
        closed = jnp.append(tangent_basis(v).T @ grad_v, grad_omega)
        scale = -(sigma**2) / objective.l2e_objective(v, omega, sigma, x, y)
        np.testing.assert_allclose(at.gradient[k], scale * closed, atol=1e-12)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
@pytest.mark.parametrize("num", [2, 3, 64])
def test_a_batch_is_its_planes_one_by_one(pairs, planes, dtype, num):
    """Sums over an axis of length 3 have been compiled wrongly under vmap, so several batch sizes are tested."""
    rows = features(*(a.astype(dtype) for a in pairs))
    criterion = Criterion(rows, jnp.asarray(0.1, dtype))
    points = planes.astype(dtype)[:num]
    one = jax.jit(lambda z: (criterion.expand(z), jax.value_and_grad(criterion.value)(z)))
    together = jax.jit(jax.vmap(one))(points)
    alone = [one(z) for z in points]
    stacked = jax.tree.map(lambda *leaves: jnp.stack(leaves), *alone)
    eps = float(jnp.finfo(dtype).eps)
    for a, b in zip(jax.tree.leaves(together), jax.tree.leaves(stacked), strict=True):
        assert a.dtype == dtype
        # Hessians are differences of moments, multiplied by 4/σ²
        np.testing.assert_allclose(a, b, rtol=500 * eps, atol=4000 * eps)


def test_scatter_and_middle_are_weighted_moments(pairs, planes):
    x, y, weights = (np.asarray(a) for a in pairs)
    at = expanded(pairs, 0.3, planes)
    m, h = (x + y) / 2, (y - x) / 2
    for k in range(0, 64, 9):
        p = weights * np.asarray(objective.l2e_weights(planes[k, :3], planes[k, 3], 0.3, *pairs[:2]))
        p = p / p.sum()
        middle = p @ m
        np.testing.assert_allclose(at.mean_midpoint[k], middle, atol=1e-12)
        scatter = (m - middle).T @ (p[:, None] * (m - middle)) - h.T @ (p[:, None] * h)
        np.testing.assert_allclose(at.scatter[k], scatter, atol=1e-12)


@pytest.mark.parametrize("sigma", [0.005, 0.05, 0.5])
def test_an_mm_step_never_raises_psi(pairs, planes, sigma):
    """The step is the least-squares plane under the weights, here by LAPACK."""
    points = planes
    for _ in range(4):
        at = expanded(pairs, sigma, points)
        values, vectors = jnp.linalg.eigh(at.scatter)
        after = jax.vmap(mm_step)(at, values, vectors)
        np.testing.assert_allclose(jnp.linalg.norm(after[:, :3], axis=1), 1, rtol=1e-12)
        assert (jnp.sum(after[:, :3] * points[:, :3], axis=1) >= 0).all()
        risen = expanded(pairs, sigma, after).value - at.value
        assert risen.max() <= 1e-14
        points = after
    assert (at.value < expanded(pairs, sigma, planes).value).all()


@pytest.mark.any_precision
def test_planes_far_from_every_pair_keep_their_gradient(pairs, planes):
    """If every weight underflows, ψ is half the f of the best pair."""
    x, y, _ = pairs = [jnp.asarray(a, jnp.float32) for a in pairs]
    points = planes.astype(jnp.float32)[:8].at[:, 3].add(50.0)
    at = expanded(pairs, jnp.float32(0.01), points)
    f = jax.vmap(objective.squared_residuals, (0, 0, None, None))(points[:, :3], points[:, 3], x, y)
    assert (jnp.exp(-f / (2 * 0.01**2)) == 0).all()
    np.testing.assert_allclose(at.value, 0.5 * f.min(axis=1), rtol=1e-4)
    nearest = jax.vmap(lambda z, row: jnp.sum(z[:3] * (x + y)[row] / 2))(points, f.argmin(axis=1))
    np.testing.assert_allclose(at.gradient[:, 2], 4 * (points[:, 3] - nearest), rtol=1e-3)
    slope = jax.vmap(jax.grad(Criterion(features(*pairs), jnp.float32(0.01)).value))(points)
    np.testing.assert_allclose(slope[:, 3], at.gradient[:, 2], rtol=1e-4)
