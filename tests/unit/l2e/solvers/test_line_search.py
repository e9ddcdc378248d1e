from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.l2e.solvers import line_search
from symjax.l2e.solvers.line_search import Trial, armijo

PROFILES = {
    "parabola": lambda t: (t - 1.0) ** 2,
    "steep": lambda t: 1e4 * (t - 1e-3) ** 2,
    "shallow": lambda t: -jnp.tanh(t / 20) + 1e-4 * t**2,
    "wavy": lambda t: jnp.sin(5 * t) - t + 0.1 * t**2,
}


def trial_at(profile, t):
    value, slope = jax.value_and_grad(profile)(t)
    return Trial(t, t[None], value, slope[None], slope)


def searched(name, step):
    curve = partial(trial_at, PROFILES[name])
    start = curve(jnp.asarray(0.0))
    if start.slope > 0:  # search downhill
        curve = partial(trial_at, lambda t: PROFILES[name](-t))
        start = curve(jnp.asarray(0.0))
    trial, found = jax.jit(lambda step: armijo(curve, start, step))(jnp.asarray(step))
    return start, trial, found


@pytest.mark.parametrize("step", [1e-3, 1.0, 30.0])
@pytest.mark.parametrize("name", PROFILES)
def test_armijo_step_decreases_enough_and_never_exceeds_the_first(name, step):
    start, trial, found = searched(name, step)
    assert found
    assert trial.value <= start.value + line_search.DECREASE * trial.step * start.slope
    assert 0 < trial.step <= step


@pytest.mark.any_precision
def test_no_step_is_found_if_the_slope_is_wrong():
    def curve(t):
        return Trial(t, t[None], 1 + t, jnp.ones(1), jnp.ones(()))

    start = curve(jnp.asarray(0.0))._replace(slope=jnp.asarray(-1.0))
    _, found = armijo(curve, start, jnp.asarray(1.0))
    assert not found


def test_a_level_step_to_rounding_is_accepted_on_its_slope():
    """Armijo's condition requires a decrease of 1e-21 of a value of 1, which float64 cannot represent."""

    def curve(t):
        return Trial(t, t[None], jnp.asarray(1.0), jnp.zeros(1), 1e-17 * (t - 1))

    trial, found = armijo(curve, curve(jnp.asarray(0.0)), jnp.asarray(1.0))
    assert found
    np.testing.assert_array_equal(trial.step, 1)


def test_a_step_out_of_the_domain_of_the_function_is_shortened():
    curve = partial(trial_at, lambda t: -jnp.log(2.0 - t) * 0 - jnp.sqrt(2.0 - t) - 2 * t)
    trial, found = armijo(curve, curve(jnp.asarray(0.0)), jnp.asarray(3.0))
    assert found
    assert trial.step < 2
    assert jnp.isfinite(trial.value)
