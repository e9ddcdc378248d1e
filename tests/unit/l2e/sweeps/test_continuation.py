"""A continuation is never worse than independent fits at every σ, for random and structured outliers."""

import jax
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import deviation_angle
from symjax.l2e.fit import best
from symjax.l2e.sweep import sweep
from tests.helpers.structured_pairs import structured_pairs

NUM = 250
SIGMAS = np.geomspace(0.4, 0.01, 8)

CLOUDS = {
    **{f"random {share:.0%}": lambda seed, share=share: made(seed, share) for share in (0.5, 0.8, 0.95)},
    "a second plane": lambda seed: structured_pairs(seed, NUM)[0],
}


def made(seed, share):
    return planted_pairs(np.random.default_rng(seed), NUM, share)


def objective(fits):
    """The objective of Eq. 5: the constant first term of the loss, minus the loss."""
    return (4 * np.pi * np.asarray(fits.sigma) ** 2) ** -1.5 - np.asarray(fits.loss)


@pytest.mark.slow
@pytest.mark.parametrize("kind", CLOUDS)
def test_the_best_is_never_worse_than_that_of_independent_fits(kind):
    for seed in range(4):
        p = CLOUDS[kind](seed)
        followed = best(sweep(p.x, p.y, SIGMAS, continuation=True))
        assert followed.converged.all()
        for start in ("hypotheses", "fibonacci"):
            alone = best(sweep(p.x, p.y, SIGMAS, start))
            worse = np.log(objective(alone)) - np.log(objective(followed))
            assert worse.max() <= 1e-6


@pytest.fixture(scope="module")
def rival():
    return structured_pairs(1, NUM)


@pytest.fixture(scope="module")
def followed(rival):
    return sweep(rival[0].x, rival[0].y, SIGMAS, continuation=True)


def test_it_switches_planes_when_another_becomes_better(rival, followed):
    """The second plane is better at a large σ, the planted one near the noise. Warm starts alone keep the second."""
    p, (normal, _) = rival
    plane = best(followed).plane
    assert deviation_angle(plane.normal[0], normal) < 5
    assert (deviation_angle(plane.normal[-3:], p.normal[None]) < 1).all()


def test_sigmas_keep_the_order_they_are_given_in(rival, followed):
    p, _ = rival
    order = np.random.default_rng(2).permutation(8)
    shuffled = sweep(p.x, p.y, SIGMAS[order], continuation=True)
    for a, b in zip(jax.tree.leaves(shuffled), jax.tree.leaves(followed), strict=True):
        np.testing.assert_allclose(a, np.asarray(b)[order], rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(shuffled.sigma, np.tile(SIGMAS[order][:, None], 64), rtol=1e-12)


def test_every_start_has_a_fit_that_converged(followed):
    assert followed.loss.shape == followed.plane.offset.shape == (8, 64)
    assert followed.converged.all()
    assert followed.start is None
