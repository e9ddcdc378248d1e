"""Starts at known angles from the true plane, and the results from them."""

import numpy as np
import pytest

from experiments.studies.paper import start_angle
from symjax.geometry.distance import offset_error
from symjax.geometry.plane import Plane


@pytest.mark.parametrize("degrees", [0.0, 20.0, 90.0])
def test_a_start_differs_from_the_true_plane_by_its_angle_only(rng, degrees):
    normal = rng.normal(size=3)
    truth = Plane(normal / np.linalg.norm(normal), np.asarray(3.0))
    centre = 10 * rng.normal(size=3)
    start = start_angle.rotated(truth, centre, degrees, rng)
    assert np.linalg.norm(start.normal) == pytest.approx(1.0)
    assert start.angle(truth) == pytest.approx(degrees, abs=1e-6)
    assert offset_error(start, truth, centre, 1.0) == pytest.approx(0.0, abs=1e-12)


def test_alternation_stays_at_the_true_plane_of_an_exact_cloud_far_from_the_origin(rng):
    half = rng.uniform(0.2, 1.0, size=(200, 3)) * [1.0, 2.0, 3.0]
    points = np.concatenate([half, half * [-1, 1, 1]]) + [7.0, 0.0, 0.0]
    end = start_angle._three_d_symm(points)(Plane(np.array([1.0, 0.0, 0.0]), np.asarray(7.0)))
    np.testing.assert_allclose(end.normal, [1.0, 0.0, 0.0], atol=1e-9)
    assert end.offset == pytest.approx(7.0)


def test_shares_and_the_angle_up_to_which_they_reach_90_percent():
    ends = {0.0: (1, 1), 10.0: (1, 2), 20.0: (1, 80), 30.0: (1, 1)}
    common = {"condition": "clean", "model": "a", "seed": 0}
    rows = [common | start_angle._row("3DSymm", start, angle) for start, angles in ends.items() for angle in angles]
    (line,) = start_angle.summary(rows)
    assert [line[f"{start:g} deg"] for start in ends] == [1.0, 1.0, 0.5, 1.0]
    assert line["90 % up to, deg"] == 10.0
    assert "20" in line["paper"]
    (never,) = start_angle.summary([common | start_angle._row("3DSymm", 0.0, 50.0)])
    assert never["90 % up to, deg"] == "-"


def test_l2e_reaches_the_plane_of_a_ball_without_outliers_from_every_start():
    config = start_angle.Config(angles="0,45", seeds=1, num_pairs=200, outliers="0")
    rows = list(start_angle._on_planted_pairs(config))
    assert all(row["within"] for row in rows if row["model"] == "isotropic")
