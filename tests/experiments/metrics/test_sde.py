"""Symmetry distance error."""

import numpy as np
import pytest

from experiments.metrics.sde import cloud_sde
from symjax.io.mesh import sample
from tests.experiments.metrics.cubes import BOX, tilted


def test_sde_of_a_cloud_equals_that_of_its_surface(rng):
    points, dense = sample(BOX, 20_000, rng), sample(BOX, 40_000, rng)
    assert abs(cloud_sde(tilted(0.0), points, dense, np.sqrt(3))) < 2e-6
    # the mirror images are shifted by 0.1: one end face is 0.1 outside, the other is inside and near its edges closer
    # to the side faces; a tenth of each side face is outside
    inside = 0.8**2 * 0.1**2 + 4 * (0.1**3 / 3 - 0.1**4 / 2)
    exact = (0.1**2 / 6 + inside / 6 + 4 / 6 * 0.1 * 0.1**2 / 3) / 3
    assert cloud_sde(tilted(0.0, 0.05), points, dense, np.sqrt(3)) == pytest.approx(exact, rel=0.1)


def test_sde_does_not_depend_on_units(rng):
    points, dense = sample(BOX, 500, rng), sample(BOX, 5000, rng)
    small = cloud_sde(tilted(2.0, 0.01), points, dense, 1.0)
    assert cloud_sde(tilted(2.0, 10.0), 1000 * points, 1000 * dense, 1000.0) == pytest.approx(small, rel=1e-9)
