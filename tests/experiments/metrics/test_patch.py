"""Bounded rectangles of planes."""

import numpy as np
import pytest

from experiments.metrics import patch
from tests.experiments.metrics.cubes import AXES, CUBE


def test_corners_of_a_file_give_the_centre_of_the_rectangle():
    # a plane of the organisers' table: x = 0, and the first corner is adjacent to both others
    corners = np.array([[[0, -3.61376, -1.39425], [0, -3.61376, 1.39425], [0, 3.61376, -1.39425]]])
    rectangle = patch.from_corners(corners)
    assert np.abs(rectangle.normals) == pytest.approx(AXES[:1])
    assert rectangle.centres == pytest.approx(np.zeros((1, 3)))
    assert rectangle.sides == pytest.approx([2 * 1.39425])
    assert patch.from_corners(corners, as_printed=True).centres == pytest.approx(np.array([[0, 0, -1.39425]]))


@pytest.mark.parametrize("axis", range(3))
def test_a_rectangle_bounds_the_cloud_on_its_plane(axis):
    points = CUBE * [1.0, 2.0, 4.0] + [10.0, 20.0, 30.0]
    rectangle = patch.bounding((AXES[axis : axis + 1], np.array([0.25])), points)
    centre = np.where(AXES[axis] == 1, 0.25, [10.0, 20.0, 30.0])
    assert rectangle.centres[0] == pytest.approx(centre)
    assert rectangle.sides[0] == pytest.approx(min(np.delete([1.0, 2.0, 4.0], axis)))
