"""Symmetry distance error."""

import numpy as np
import pytest

from experiments.metrics.sde import cloud_sde, mean_sde, sde
from symjax.io.mesh import sample
from tests.experiments.metrics.cubes import BOX, CUBE, tilted


def test_sde_of_a_cube_is_none_on_its_planes_and_known_beside_them(rng):
    assert sde(tilted(0.0), BOX, rng) == pytest.approx(0.0, abs=1e-30)
    shifted = sde(tilted(0.0, 0.05), BOX, np.random.default_rng(3), num_samples=20_000)
    # images are shifted by 0.1: one end is 0.1 outside; the other is inside, nearer to the sides at its rim; of the
    # sides a tenth sticks out
    inside = 0.8**2 * 0.1**2 + 4 * (0.1**3 / 3 - 0.1**4 / 2)
    assert shifted == pytest.approx((0.1**2 / 6 + inside / 6 + 4 / 6 * 0.1 * 0.1**2 / 3) / 3, rel=0.02)


def test_sde_does_not_depend_on_units():
    small = sde(tilted(2.0, 0.01), BOX, np.random.default_rng(0))
    large = sde(tilted(2.0, 10.0), BOX._replace(vertices=1000 * CUBE), np.random.default_rng(0))
    assert large == pytest.approx(small, rel=1e-9)


def test_sde_of_a_cloud_is_near_that_of_its_surface(rng):
    points, dense = sample(BOX, 2000, rng), sample(BOX, 40_000, rng)
    assert abs(cloud_sde(tilted(0.0), points, dense, np.sqrt(3))) < 2e-6
    plane = tilted(3.0, 0.03)
    exact = sde(plane, BOX, rng, num_samples=5000)
    assert cloud_sde(plane, points, dense, np.sqrt(3)) == pytest.approx(exact, rel=0.1)


def test_the_mean_sde_leaves_out_zeros():
    assert mean_sde([0.0, 1.0, 3.0]) == 2.0
