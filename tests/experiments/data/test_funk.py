"""The benchmark of Funk et al."""

import numpy as np
import pytest

from experiments.comparison import objects
from experiments.data import funk
from experiments.metrics import patch
from symjax.errors import FileFormatError
from tests.experiments.data.files import OFF, PLY, TABLE, same, write


def test_funk_models_are_loaded_with_their_planes(tmp_path):
    write(tmp_path / "table.ply", PLY)
    write(tmp_path / "table-plane.txt", TABLE)
    write(tmp_path / "a.b-.ply", PLY)
    write(tmp_path / "a.b-plane.txt", "0\n")
    write(tmp_path / "readme.txt", "not a model")
    odd, table = funk.load(tmp_path)
    assert (odd.name, table.name) == ("a.b-", "table")
    assert odd.planes == ()
    assert same(table.planes[0], [1, 0, 0], 0)
    assert same(table.planes[1], [0, 1, 0], 0)
    assert table.diagonal == pytest.approx(np.sqrt(2))


def test_a_pose_moves_rectangles_with_their_shape(tmp_path):
    write(tmp_path / "table.ply", PLY)
    write(tmp_path / "table-plane.txt", TABLE)
    (shape,) = funk.load(tmp_path)
    posed = shape.posed(4)
    assert len(posed.surface.vertices) == len(shape.surface.vertices)
    before, after = patch.from_corners(shape.corners), patch.from_corners(posed.corners)
    np.testing.assert_allclose(after.sides, before.sides)
    for plane, normal, centre in zip(posed.planes, after.normals, after.centres, strict=True):
        assert abs(plane.normal @ normal) == pytest.approx(1.0)
        assert plane.normal @ centre == pytest.approx(float(plane.offset))
    whole = objects.benchmark_object("funk", str(tmp_path), 0, 4, 2)
    np.testing.assert_array_equal(whole.truths.centres, after.centres)


def test_corners_of_funk_are_those_of_rectangles(tmp_path):
    corners = funk.read_corners(write(tmp_path / "table-plane.txt", TABLE))
    assert patch.from_corners(corners).centres == pytest.approx(np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("two\n", 1, "the number of planes"),
        ("1\n0 0 0\n0 1\n0 0 1\n3\n", 3, "a corner"),
        ("1\n0 0 0\n0 1 x\n0 0 1\n3\n", 3, "a corner"),
        ("1\n0 0 0\n0 nan 0\n0 0 1\n3\n", 3, "a corner"),
        ("1\n\n0 0 0\n0 1 0\n0 2 0\n3\n", 5, "collinear"),
        ("1\n0 0 0\n0 1 0\n0 0 1\n", 4, "but the file ends"),
        ("1\n0 0 0\n0 1 0\n0 0 1\n3\n4\n", 6, "expected the end of the file"),
        ("", 1, "the file ends"),
    ],
)
def test_a_malformed_file_of_funk_is_refused_by_line(text, line, message, tmp_path):
    path = write(tmp_path / "bad-plane.txt", text)
    with pytest.raises(FileFormatError, match=rf"bad-plane\.txt, line {line}: .*{message}"):
        funk.read_corners(path)


def test_funk_refuses_models_without_planes_and_planes_without_model(tmp_path):
    write(tmp_path / "one-plane.txt", "0\n")
    write(tmp_path / "two.ply", PLY)
    with pytest.raises(FileFormatError, match=r"1 models have no file of planes, 1 files .*; for example, model 'two'"):
        funk.load(tmp_path)
    write(tmp_path / "two.off", OFF)
    with pytest.raises(FileFormatError, match="2 model files share 1 names"):
        funk.load(tmp_path)
