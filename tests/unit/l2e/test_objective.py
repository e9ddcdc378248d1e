import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.l2e import objective
from symjax.l2e.manifolds import tangent_projection
from tests.helpers.formulas import exponential, polynomial_f

SIGMA = 0.3


@pytest.fixture
def pairs(rng):
    """Unrelated points as pairs, and an unrelated plane."""
    x, y, v = rng.normal(size=(40, 3)), rng.normal(size=(40, 3)), rng.normal(size=3)
    return jnp.asarray(v / np.linalg.norm(v)), jnp.asarray(0.3), jnp.asarray(0.4 * x), jnp.asarray(0.4 * y)


def test_residual_is_the_distance_from_the_mirror_image(pairs):
    v, omega, x, y = pairs
    image = x - 2 * (x @ v - omega)[:, None] * v[None, :]
    np.testing.assert_allclose(objective.squared_residuals(v, omega, x, y), ((y - image) ** 2).sum(1), rtol=1e-12)


def test_residual_is_the_papers_polynomial_on_the_sphere(pairs):
    np.testing.assert_allclose(objective.squared_residuals(*pairs), polynomial_f(*pairs), rtol=1e-12)


def test_residual_ignores_order_and_orientation(pairs):
    v, omega, x, y = pairs
    f = objective.squared_residuals(v, omega, x, y)
    np.testing.assert_array_equal(objective.squared_residuals(v, omega, y, x), f)
    np.testing.assert_array_equal(objective.squared_residuals(-v, -omega, x, y), f)


def test_closed_form_gradients_are_those_of_autodiff(pairs):
    v, omega, x, y = pairs
    auto_v, auto_omega = jax.grad(objective.l2e_objective, argnums=(0, 1))(v, omega, SIGMA, x, y)
    grad_v, grad_omega = objective.l2e_gradients(v, omega, SIGMA, x, y)
    auto, closed = tangent_projection(v, auto_v), tangent_projection(v, grad_v)
    assert jnp.linalg.norm(auto - closed) <= 1e-13 * jnp.linalg.norm(closed)
    assert abs(auto_omega - grad_omega) <= 1e-13 * abs(grad_omega)


def test_closed_form_is_the_euclidean_gradient_of_the_papers_polynomial(pairs):
    v, omega, x, y = pairs

    def printed(v, omega):
        f_i = polynomial_f(v, omega, x, y)
        return 2 / len(x) * jnp.sum(jnp.exp(-f_i / (2 * SIGMA**2))) / (2 * jnp.pi * SIGMA**2) ** 1.5

    expected = jax.grad(printed, argnums=(0, 1))(v, omega)
    for a, b in zip(objective.l2e_gradients(v, omega, SIGMA, x, y), expected, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-12)


def test_taylor_error_falls_with_slope_two(pairs):
    v, omega, x, y = pairs
    direction = tangent_projection(v, jnp.asarray([1.0, -2.0, 0.5]))
    grad_v, grad_omega = objective.l2e_gradients(v, omega, SIGMA, x, y)
    first_order = grad_v @ direction + 0.7 * grad_omega
    steps = np.array([1e-3, 1e-4, 1e-5])

    def error(t):
        moved = objective.l2e_objective(exponential(v, t * direction), omega + 0.7 * t, SIGMA, x, y)
        return abs(moved - objective.l2e_objective(v, omega, SIGMA, x, y) - t * first_order)

    slope = np.polyfit(np.log(steps), np.log([error(t) for t in steps]), 1)[0]
    assert slope == pytest.approx(2, abs=0.05)


def test_loss_is_barrons_welsch_loss_up_to_scale(pairs):
    """General robust loss (Barron, CVPR 2019), α = −∞: 1 − exp(−(r/c)²/2)."""
    v, omega, x, y = pairs
    r = jnp.sqrt(objective.squared_residuals(v, omega, x, y))
    welsch = jnp.mean(1 - jnp.exp(-0.5 * (r / SIGMA) ** 2))
    peak = (2 * np.pi * SIGMA**2) ** -1.5
    loss = objective.l2e_loss(v, omega, SIGMA, x, y)
    np.testing.assert_allclose(loss, (4 * np.pi * SIGMA**2) ** -1.5 - 2 * peak * (1 - welsch), rtol=1e-12)


def test_first_term_of_the_loss_is_the_integral_of_the_squared_density():
    # integrated over the radius; the paper prints (2πσ²)^(-3/2)
    r = np.linspace(0, 12 * SIGMA, 20_001)
    density = np.exp(-(r**2) / (2 * SIGMA**2)) / (2 * np.pi * SIGMA**2) ** 1.5
    integral = np.trapezoid(4 * np.pi * r**2 * density**2, r)
    far = jnp.full((3, 3), 100.0)
    loss = objective.l2e_loss(jnp.asarray([0.0, 0.0, 1.0]), jnp.asarray(0.0), SIGMA, far, far)
    np.testing.assert_allclose(loss, integral, rtol=1e-8)


def test_integer_weights_are_repeated_pairs(pairs):
    v, omega, x, y = pairs
    counts = np.arange(40) % 3
    repeated = jnp.repeat(x, counts, axis=0), jnp.repeat(y, counts, axis=0)
    for function in (objective.l2e_loss, objective.log_objective, objective.scaled_log_loss):
        weighted = function(v, omega, SIGMA, x, y, weights=jnp.asarray(counts, float))
        np.testing.assert_allclose(weighted, function(v, omega, SIGMA, *repeated), rtol=1e-12)


@pytest.mark.any_precision
def test_log_form_keeps_its_slope_where_every_weight_underflows(pairs):
    v, omega, x, y = (jnp.asarray(a, jnp.float32) for a in pairs)
    omega = omega + 10
    assert (objective.l2e_weights(v, omega, 0.01, x, y) == 0).all()
    assert jax.grad(objective.l2e_objective, argnums=1)(v, omega, 0.01, x, y) == 0
    slope = jax.grad(objective.scaled_log_loss, argnums=1)(v, omega, 0.01, x, y)
    assert jnp.isfinite(slope)
    assert slope > 1


@pytest.mark.any_precision
def test_a_pair_of_weight_zero_may_fit_infinitely_better(pairs):
    v, omega, x, y = pairs
    x = x.at[0].set(v * omega)
    weights = jnp.ones(len(x)).at[0].set(0)
    far = omega + 50
    loss, grad = jax.value_and_grad(objective.scaled_log_loss, argnums=(0, 1))(
        v, far, 0.01, x.at[0].set(v * far), y.at[0].set(v * far), weights=weights
    )
    assert jnp.isfinite(loss)
    assert all(jnp.isfinite(g).all() for g in grad)


def test_log_objective_is_the_logarithm(pairs):
    direct = jnp.log(jnp.sum(objective.l2e_weights(*pairs[:2], SIGMA, *pairs[2:])))
    np.testing.assert_allclose(objective.log_objective(*pairs[:2], SIGMA, *pairs[2:]), direct, rtol=1e-12)
