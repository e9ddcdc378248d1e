"""Sweeps of many clouds: the axis of the clouds comes first, and few sizes are compiled."""

import jax
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError, TooFewPointsError
from symjax.geometry.directions import deviation_angle, fibonacci
from symjax.l2e.fit import best
from symjax.l2e.pairs.padded import LEAST_SIZE, padded_size
from symjax.l2e.sweep import _sweep, sweep, sweep_clouds

COMPILED = "/jax/core/compile/backend_compile_duration"
SIGMAS, STARTS = [0.05], fibonacci(2)


def clouds(sizes):
    return [planted_pairs(np.random.default_rng(size), size, 0.2) for size in sizes]


def test_a_hundred_sizes_are_compiled_at_most_eight_times():
    sizes = np.unique(np.geomspace(3, 4000, 140).astype(int))[-100:].tolist()
    assert len(sizes) == 100
    counts = []

    def listen(event, _, **about):
        if event == COMPILED:
            counts.append(about.get("fun_name"))

    made = [(p.x, p.y) for p in clouds(sizes)]
    before = _sweep._cache_size()
    jax.monitoring.register_event_duration_secs_listener(listen)
    try:
        fits = sweep_clouds(made, SIGMAS, STARTS, solver="irls", max_steps=3)
    finally:
        jax.monitoring.unregister_event_duration_listener(listen)
    assert fits.loss.shape == (100, 1, 2)
    assert _sweep._cache_size() - before <= 8
    # nor is anything else compiled for every size
    assert sum("sweep" in str(name) for name in counts) <= 8
    assert len(counts) <= 40


@pytest.mark.parametrize("num", [1, 3, 255, 256, 257, 1000, 1024, 1025])
def test_a_bucket_is_the_next_power_of_two(num):
    size = padded_size(num)
    assert size >= max(num, LEAST_SIZE)
    assert size & (size - 1) == 0
    assert size == LEAST_SIZE or size < 2 * num


@pytest.fixture(scope="module")
def three():
    return clouds([40, 250, 120])


@pytest.mark.slow
def test_axes_are_clouds_sigmas_and_starts(three):
    fits = sweep_clouds(((p.x, p.y) for p in three), [0.05, 0.1], fibonacci(7))
    assert fits.plane.normal.shape == (3, 2, 7, 3)
    assert fits.loss.shape == fits.converged.shape == fits.num_steps.shape == fits.message.shape == (3, 2, 7)
    for k, p in enumerate(three):
        alone = sweep(p.x, p.y, [0.05, 0.1], fibonacci(7))
        for a, b in zip(jax.tree.leaves(fits), jax.tree.leaves(alone), strict=True):
            np.testing.assert_array_equal(a[k], b)
    found = best(fits)
    assert found.loss.shape == (3, 2)
    for k, p in enumerate(three):
        assert (deviation_angle(found.plane.normal[k], p.normal[None]) < 1).all()


def test_invalid_clouds_are_refused(three):
    with pytest.raises(InvalidArgumentError, match="clouds is empty"):
        sweep_clouds([], [0.05])
    bad = [(three[0].x, three[0].y), (three[1].x[:2], three[1].y[:2])]
    with pytest.raises(TooFewPointsError, match="2 pairs"):
        sweep_clouds(bad, [0.05, 0.1], fibonacci(7))
