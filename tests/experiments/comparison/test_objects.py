"""The objects of benchmarks by number."""

import numpy as np
import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")

from scipy.spatial import KDTree

from experiments.comparison import objects
from experiments.data.shape import Shape
from experiments.framework.absence import DataAbsentError
from symjax.geometry.plane import Plane
from symjax.io.mesh import Mesh


def test_the_dense_sample_is_on_the_same_surface_and_shares_no_point_with_the_case():
    case, dense, truths = objects.benchmark_object("procedural", "", 4, 0, 500)
    assert truths is None
    assert (len(case.points), len(dense)) == (500, objects.DENSE)
    apart = KDTree(dense).query(case.points)[0]
    assert apart.min() > 0
    assert apart.max() < 0.05 * case.diagonal


def test_objects_differ_by_number_and_by_seed():
    one, again, other, seed = (
        objects.benchmark_object("procedural", "", item, s, 200).case for item, s in ((2, 0), (2, 0), (3, 0), (2, 1))
    )
    np.testing.assert_array_equal(one.points, again.points)
    assert one.name != other.name
    assert one.name == seed.name
    assert not np.allclose(one.points, seed.points)


def test_items_are_the_objects_with_a_mirror_plane(models):
    folder = str(models.parent)
    names = objects.items("folder", folder, 3)
    assert list(names) == [0, 1, 2]
    whole = objects.benchmark_object("folder", folder, 2, 1, 300)
    assert whole.case.name == names[2]
    image = whole.case.planes[0].reflect(whole.case.points)
    assert KDTree(whole.dense).query(image)[0].max() < 0.05 * whole.case.diagonal
    assert objects.benchmark_object("folder", folder, 0, 1, 300).case.name != whole.case.name


def test_absent_data_give_a_message_or_an_error(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(objects, "MODELS", tmp_path)
    assert objects.items("real", "", 3) == {}
    assert "REAL MODELS ARE ABSENT" in capsys.readouterr().err
    with pytest.raises(DataAbsentError, match="DATA IS ABSENT"):
        objects.items("funk", str(tmp_path / "none"), 3)


def test_objects_with_an_axis_or_without_a_plane_are_skipped_with_a_message(capsys, monkeypatch, tmp_path):
    cloud = Shape("a", "group", Mesh(np.eye(3), np.empty((0, 3), int), 0), (), 1.0)
    plane, axis = Plane(np.eye(3)[0], np.asarray(0.0)), (np.zeros(3), np.eye(3)[0])
    shapes = [cloud, cloud._replace(name="b", planes=(plane,)), cloud._replace(name="c", planes=(plane,), axis=axis)]
    monkeypatch.setitem(objects.LOADERS, "ycb", lambda folder: iter(shapes))
    assert objects.items("ycb", str(tmp_path), 9) == {1: "b"}
    assert "ycb: 2 OF 3 OBJECTS" in capsys.readouterr().err
