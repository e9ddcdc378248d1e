"""Binary glTF: all parts of a scene are read, and damaged files are refused."""

import contextlib

import numpy as np
import pytest
import trimesh

from symjax.errors import FileFormatError
from symjax.io.points import read_points


@pytest.fixture
def scene():
    """Two boxes; the scene translates the second."""
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1.0, 2.0, 3.0)))
    scene.add_geometry(
        trimesh.creation.box((1.0, 1.0, 1.0)), transform=trimesh.transformations.translation_matrix((9, 0, 0))
    )
    return scene


def test_all_meshes_are_sampled_at_their_positions_in_the_scene(scene, tmp_path):
    path = tmp_path / "scan.glb"
    path.write_bytes(scene.export(file_type="glb"))
    points, note = read_points(path, num_samples=4000)
    np.testing.assert_allclose(points.min(axis=0), [-0.5, -1.0, -1.5], atol=0.02)
    np.testing.assert_allclose(points.max(axis=0), [9.5, 1.0, 1.5], atol=0.02)
    # the areas are 22 and 6
    assert (points[:, 0] > 5).mean() == pytest.approx(6 / 28, abs=0.03)
    assert "2 parts, merged" in note


def test_a_cloud_is_read_unchanged(rng, tmp_path):
    path = tmp_path / "cloud.GLB"
    given = rng.normal(size=(100, 3)).astype(np.float32)
    path.write_bytes(trimesh.Scene(trimesh.PointCloud(given)).export(file_type="glb"))
    np.testing.assert_array_equal(read_points(path).points, given)


def test_a_truncated_file_is_refused_and_a_mutated_one_too_or_read(scene, tmp_path, rng):
    data = scene.export(file_type="glb")
    path = tmp_path / "scan.glb"
    for length in (0, 4, 11, 12, 40, len(data) // 2, len(data) - 1):
        path.write_bytes(data[:length])
        with pytest.raises(FileFormatError, match=r"scan\.glb"):
            read_points(path)
    read = 0
    for _ in range(100):
        mutated = bytearray(data)
        mutated[rng.integers(len(data))] = rng.integers(256)
        path.write_bytes(mutated)
        with contextlib.suppress(FileFormatError):
            assert read_points(path, num_samples=10).points.shape == (10, 3)
            read += 1
    assert 0 < read < 100
