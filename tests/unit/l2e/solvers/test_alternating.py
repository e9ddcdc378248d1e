import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.objective import scaled_log_loss
from symjax.l2e.solvers.alternating import alternate
from symjax.l2e.solvers.rbfgs import minimise
from symjax.l2e.status import Status


@pytest.fixture(scope="module")
def problem():
    p = planted_pairs(np.random.default_rng(3), 60, 0.4, shift=0.3)
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    v = p.normal + 0.05 * np.random.default_rng(4).normal(size=3)
    return lambda z: scaled_log_loss(z[:3], z[3], 0.05, x, y), jnp.append(v / np.linalg.norm(v), p.offset)


def test_same_optimum_as_riemannian_bfgs_in_several_rounds(problem):
    turns = alternate(*problem, tol=1e-7)
    both = minimise(*problem, manifold=SPHERE_LINE, tol=1e-10)
    assert turns.status == Status.SUCCESSFUL
    np.testing.assert_allclose(turns.point, both.point, atol=1e-6)
    assert 1 < turns.num_steps < 200


@pytest.mark.slow
def test_value_never_rises_from_round_to_round(problem):
    solve = jax.jit(lambda rounds: alternate(*problem, max_steps=rounds, tol=1e-7).value)
    values = np.array([solve(rounds) for rounds in range(5)])
    assert (np.diff(values) <= 1e-16).all()
    assert values[1] < values[0]
