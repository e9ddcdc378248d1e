"""Batched solves equal the solves one by one, for any number, any cost and several devices."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import fibonacci
from symjax.l2e.solvers.base import Minimum, Solver, final_status, solve
from symjax.l2e.solvers.batched import solve_batch
from symjax.l2e.status import Status
from symjax.l2e.sweep import sweep

MAX_STEPS = 90


def halving(factor, seen: Callable[[jax.Array], None] | None = None) -> Solver:
    """A solver of known cost that compiles fast: it multiplies the start by a factor until it is below 1e-6."""

    def should_continue(state):
        z, k = state
        return (jnp.abs(z[0]) > 1e-6) & (k < MAX_STEPS)

    def step(state):
        z, k = state
        if seen is not None:
            jax.debug.callback(seen, k)
        return factor * z, k + 1

    def finish(state):
        z, k = state
        return Minimum(z, z[0], jnp.abs(z[0]), k, final_status(jnp.abs(z[0]), 1e-6, z[0], jnp.asarray(False)))

    return Solver(lambda start: (start, jnp.asarray(0)), should_continue, step, finish)


def solves(num, seed=0):
    """Solves that take no, few, many or all allowed steps, and some that are NaN."""
    rng = np.random.default_rng(seed)
    factor = rng.choice([0.01, 0.3, 0.8, 0.99], num, p=[0.4, 0.3, 0.2, 0.1])
    start = rng.choice([1e-9, 1.0, 1e3, np.nan], (num, 1), p=[0.1, 0.5, 0.3, 0.1])
    return jnp.asarray(factor), jnp.asarray(start + [0.0, 1.0])


one_by_one = jax.jit(jax.vmap(lambda factor, start: solve(halving(factor), start)))
together = jax.jit(lambda factor, starts: solve_batch(halving, factor, starts))


def assert_same(found, expected, **tolerance):
    for a, b in zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True):
        assert a.dtype == b.dtype
        np.testing.assert_allclose(a, b, **tolerance)


@pytest.mark.parametrize("num", [1, 31, 32, 33, 64, 65, 256, 257, 300, 700])
def test_a_batch_is_the_solves_one_by_one(num):
    factor, starts = solves(num)
    for order in (slice(None), slice(None, None, -1), np.argsort(factor), np.argsort(-factor)):
        expected = one_by_one(factor[order], starts[order])
        assert_same(together(factor[order], starts[order]), expected, rtol=0)
        if num > 100:
            assert len(np.unique(expected.num_steps)) > 5
            assert len(np.unique(expected.status)) == 3
            assert expected.num_steps.max() == MAX_STEPS


@pytest.mark.parametrize("factor", [0.01, 0.99, jnp.nan])
def test_solves_of_one_cost(factor):
    starts = jnp.ones((300, 2))
    found = together(jnp.full(300, factor), starts)
    assert len(np.unique(found.num_steps)) == 1
    assert found.num_steps[0] == {0.01: 4, 0.99: MAX_STEPS}.get(factor, 1)


def test_parameters_may_be_trees():
    factor, starts = solves(70)

    def make(parameters):
        return halving(parameters["near"] * parameters["pair"][0])

    tree = {"near": jnp.sqrt(factor), "pair": (jnp.sqrt(factor), jnp.zeros((70, 2, 2)))}
    found = jax.jit(lambda tree, starts: solve_batch(make, tree, starts))(tree, starts)
    assert_same(found, one_by_one(factor, starts), rtol=1e-12)


def test_a_batch_does_not_wait_for_its_slowest():
    """Counts the steps that are computed: of 256 solves, 8 take 90 steps and the rest 4."""
    counts = []
    factor = jnp.where(jnp.arange(256) % 32 == 5, 0.99, 0.01)
    run = jax.jit(lambda factor, starts: solve_batch(lambda f: halving(f, counts.append), factor, starts))
    found = run(factor, jnp.ones((256, 2)))
    jax.effects_barrier()
    assert found.num_steps.sum() == 8 * MAX_STEPS + 248 * 4
    assert found.num_steps.sum() < len(counts) < 256 * MAX_STEPS / 5  # under vmap all would take 90


def swept(starts):
    p = planted_pairs(np.random.default_rng(3), 100, 0.6)
    return sweep(p.x, p.y, [0.03, 0.2], starts, max_steps=9)


STARTS = fibonacci(150)


@pytest.fixture(scope="module")
def many():
    """Newton solves of very different cost; some reach max_steps."""
    fits = swept(STARTS)
    assert len(np.unique(fits.status)) == 2
    return fits


def test_a_sweep_of_many_solves_is_a_sweep_of_few(many):
    for first in range(0, 144, 16):
        few = swept(STARTS[first : first + 16])
        part = jax.tree.map(lambda leaf, first=first: leaf[:, first : first + 16], many)
        assert_same(part, few, rtol=1e-9, atol=1e-9)


DEVICES = 2

COUNTS = [1, 2, 3, 64, 65, 67, 133, 600]

PROGRAM = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
import jax, numpy as np
jax.config.update("jax_enable_x64", True)
from symjax.l2e.solvers.batched import solve_sharded
from tests.unit.l2e.solvers.test_batched import COUNTS, STARTS, halving, solves, swept
dealt = jax.jit(lambda factor, starts: solve_sharded(halving, factor, starts))
found = [dealt(*solves(num)) for num in COUNTS]
assert all(len(f.value.sharding.device_set) == {DEVICES} for f in found[1:])
np.savez(sys.argv[1], *jax.tree.leaves([*found, swept(STARTS)]))
"""


@pytest.mark.slow
def test_several_devices_give_what_one_gives(many, tmp_path):
    flags = f"{os.environ.get('XLA_FLAGS', '')} --xla_force_host_platform_device_count={DEVICES}"
    file = tmp_path / "found.npz"
    environment = os.environ | {"XLA_FLAGS": flags, "JAX_PLATFORMS": "cpu"}
    subprocess.run([sys.executable, "-c", PROGRAM, str(file)], check=True, env=environment)
    expected = jax.tree.leaves([*(one_by_one(*solves(num)) for num in COUNTS), many])
    with np.load(file) as found:
        assert len(found.files) == len(expected)
        for name, value in zip(found.files, expected, strict=True):
            np.testing.assert_allclose(found[name], value, rtol=1e-8, atol=1e-8)


def test_solves_that_reach_max_steps_report_it():
    found = together(jnp.asarray([0.99, 0.01, 0.99]), jnp.ones((3, 2)))
    expected = [Status.MAX_STEPS_REACHED, Status.SUCCESSFUL, Status.MAX_STEPS_REACHED]
    assert found.status.tolist() == expected
