import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.optimize

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.manifolds import SPHERE, SPHERE_LINE, random_points
from symjax.l2e.objective import scaled_log_loss
from symjax.l2e.solvers.rbfgs import minimise
from symjax.l2e.status import Status, sentences

SIGMA = 0.05


def quadratic(H, v0, **options):
    return minimise(lambda v: v @ H @ v, v0, manifold=SPHERE, **options)


def symmetric(rng, num):
    A = rng.normal(size=(num, 3, 3))
    return jnp.asarray(A + A.swapaxes(1, 2))


def test_finds_the_smallest_eigenvector(rng):
    H, v0 = symmetric(rng, 20), random_points(jax.random.key(0), 20)
    minima = jax.jit(jax.vmap(lambda H, v: quadratic(H, v)))(H, v0)
    smallest = np.linalg.eigh(H)[1][:, :, 0]
    sine = np.linalg.norm(np.cross(minima.point, smallest), axis=1)
    assert sine.max() <= 1e-10
    assert (minima.status == Status.SUCCESSFUL).all()
    np.testing.assert_allclose(jnp.linalg.norm(minima.point, axis=1), 1, atol=1e-14)


def test_vmap_equals_the_python_loop_and_jit_changes_nothing(rng):
    H, v0 = symmetric(rng, 4), random_points(jax.random.key(1), 4)
    together = jax.vmap(quadratic)(H, v0)
    compiled = jax.jit(quadratic)
    for k in range(4):
        alone = compiled(H[k], v0[k])
        np.testing.assert_allclose(together.point[k], alone.point, atol=1e-12)
        np.testing.assert_array_equal(together.num_steps[k], alone.num_steps)
    np.testing.assert_allclose(quadratic(H[0], v0[0]).point, together.point[0], atol=1e-12)


def test_the_tail_is_superlinear(rng):
    H, v0 = symmetric(rng, 1)[0], random_points(jax.random.key(2), 1)[0]
    solve = jax.jit(lambda k: quadratic(H, v0, max_steps=k, tol=1e-13).grad_norm)
    norms = np.array([solve(k) for k in range(1, 20)])
    tail = norms[(norms < 1e-1) & (norms > 1e-13)]
    ratios = tail[1:] / tail[:-1]
    assert len(ratios) >= 3
    assert ratios[-1] < 0.01
    assert ratios[-1] < 0.2 * ratios[0]


@pytest.fixture(scope="module")
def problem():
    p = planted_pairs(np.random.default_rng(7), 100, 0.5, shift=0.0)
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    v = p.normal + 0.1 * np.random.default_rng(8).normal(size=3)
    return lambda z: scaled_log_loss(z[:3], z[3], SIGMA, x, y), jnp.append(v / np.linalg.norm(v), p.offset + 0.03)


@pytest.fixture(scope="module")
def optimum(problem):
    return minimise(*problem, manifold=SPHERE_LINE, tol=1e-11)


def test_same_optimum_as_scipy_in_a_chart(problem, optimum):
    fun, z0 = problem
    basis = SPHERE_LINE.basis(z0)
    chart = jax.jit(jax.value_and_grad(lambda t: fun(SPHERE_LINE.retract(z0, basis @ t))))
    solved = scipy.optimize.minimize(
        lambda t: [np.asarray(a, float) for a in chart(t)], np.zeros(3), jac=True, method="BFGS", options={"gtol": 1e-9}
    )
    point = SPHERE_LINE.retract(z0, basis @ solved.x)
    np.testing.assert_allclose(optimum.point, point, atol=1e-7)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_same_optimum_as_jaxopts_projected_gradient(problem, optimum):
    jaxopt = pytest.importorskip("jaxopt", exc_type=ImportError)
    fun, z0 = problem

    def onto_the_sphere(z, _):
        return jnp.append(jaxopt.projection.projection_l2_sphere(z[:3]), z[3])

    solver = jaxopt.ProjectedGradient(fun, onto_the_sphere, maxiter=2000, tol=1e-9)
    np.testing.assert_allclose(solver.run(z0, None).params, optimum.point, atol=1e-6)


@pytest.mark.any_precision
def test_float32_stays_float32_and_converges(rng):
    H = jnp.asarray(symmetric(rng, 1)[0], jnp.float32)
    v0 = jnp.asarray([0.6, 0.0, 0.8], jnp.float32)
    minimum = quadratic(H, v0, tol=1e-5)
    assert minimum.point.dtype == jnp.float32
    assert minimum.status == Status.SUCCESSFUL
    smallest = np.linalg.eigh(np.asarray(H, float))[1][:, 0]
    assert np.linalg.norm(np.cross(minimum.point, smallest)) < 1e-5


@pytest.mark.parametrize(
    ("fun", "options", "expected"),
    [
        (lambda v: v[0] ** 2, {"max_steps": 1}, "max_steps was reached"),
        (lambda v: v[0] * jnp.nan, {}, "NaN or infinite"),
        # no gradient is below a negative tolerance
        (lambda v: 1 + jnp.sum(v * jnp.arange(1.0, 4.0)), {"tol": -1.0, "max_steps": 500}, "no lower loss"),
    ],
    ids=["steps", "nan", "rounding"],
)
def test_a_solve_that_fails_says_why(fun, options, expected):
    minimum = minimise(fun, jnp.asarray([0.48, 0.6, 0.64]), manifold=SPHERE, **options)
    assert expected in sentences(minimum.status)


def test_negative_curvature_is_crossed_in_few_steps():
    """Near a maximum the inverse Hessian has no scale to learn. Without growth this took hundreds of steps."""
    H = jnp.diag(jnp.asarray([1.0, 0.999, 0.0]))
    v0 = jnp.asarray([1.0, 1e-3, 1e-4])
    minimum = quadratic(1e-3 * H, v0 / jnp.linalg.norm(v0), max_steps=60)
    assert minimum.status == Status.SUCCESSFUL
    assert abs(minimum.point[2]) == pytest.approx(1)
