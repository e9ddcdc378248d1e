"""Deviation of a plane from the nearest true plane."""

import numpy as np
import pytest

from experiments.metrics.deviation import deviation
from symjax.geometry.plane import Plane
from tests.experiments.metrics.cubes import AXES, cube, tilted


def test_deviation_is_measured_from_the_nearest_true_plane():
    near = deviation(tilted(3.0, 0.1), cube(tilted(0.0), tilted(90.0)))
    assert near.angle == pytest.approx(3.0, abs=1e-9)
    assert near.offset == pytest.approx(0.1 / np.sqrt(3), abs=1e-9)


def test_every_plane_through_an_axis_is_correct(rng):
    case = cube()._replace(planes=(), axis=(np.array([0.2, 0.0, 0.0]), np.array([0.0, 0.0, 2.0])))
    for degrees in rng.uniform(0, 180, 5):
        plane = tilted(degrees)
        through = plane._replace(offset=np.asarray(plane.normal @ case.axis[0]))
        assert deviation(through, case) == pytest.approx((0, 0), abs=1e-9)
    leaning = Plane(np.array([np.cos(0.1), 0.0, np.sin(0.1)]), np.asarray(0.0))
    assert deviation(leaning, case).angle == pytest.approx(np.degrees(0.1), abs=1e-9)
    assert deviation(Plane(AXES[2], np.asarray(0.0)), case).angle == pytest.approx(90.0)
