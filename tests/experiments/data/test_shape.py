"""Shapes in random poses."""

import json

import numpy as np
import pytest

from experiments.data import folder
from tests.experiments.data.files import OFF, write


def test_a_pose_moves_planes_with_their_shape(tmp_path):
    write(tmp_path / "a.off", OFF)
    # the tetrahedron is its own mirror image in x = y
    listing = {"a": {"file": "a.off", "normal": [1, -1, 0], "offset": 0, "kind": "exact"}}
    write(tmp_path / "planes.json", json.dumps(listing))
    (shape,) = folder.load(tmp_path)
    one, two = (shape.case(200, seed) for seed in (0, 1))
    assert (one.name, one.seed, two.seed) == ("a", 0, 1)
    assert not np.allclose(one.points, two.points)
    for seed, case in enumerate((one, two)):
        posed = shape.posed(seed)
        images = case.planes[0].reflect(posed.surface.vertices)
        distances = np.linalg.norm(images[:, None] - posed.surface.vertices, axis=2).min(axis=1)
        np.testing.assert_allclose(distances, 0, atol=1e-12)
        assert case.diagonal == pytest.approx(np.sqrt(3))
        np.testing.assert_array_equal(shape.case(200, seed).points, case.points)
