"""The YCB objects and their annotated symmetries."""

import numpy as np
import pytest

from experiments.data import ycb
from experiments.framework.absence import DataAbsentError
from symjax.errors import FileFormatError
from tests.experiments.data.files import OBJ, same, write


def symmetries(**blocks):
    """Annotations of all objects: that of a can, unless another is passed for the k-th object as `bk`."""
    can = "0 0 0.5\n0 0.6 0.8\n0 0 0\n0 0 0\n0 0 1\n"
    return "\n".join(blocks.get(f"b{k}", can) for k in range(len(ycb.NAMES)))


def test_ycb_objects_are_loaded_with_planes_and_axes(tmp_path):
    for name in ycb.NAMES:
        write(tmp_path / "models" / name / "points.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    write(tmp_path / "models" / ycb.NAMES[1] / "textured.obj", OBJ)
    box = "0 0 0\n0.9999 -0.0098 0.0102\n0 1 0\n0 0 1\n0 0 0\n"
    write(tmp_path / "symmetries.txt", symmetries(b1=box))
    can, box = list(ycb.load(tmp_path))[:2]
    assert (can.name, len(can.planes), box.name, len(box.planes)) == (ycb.NAMES[0], 1, ycb.NAMES[1], 3)
    assert same(can.planes[0], [0, 0.6, 0.8], 0.4)
    np.testing.assert_allclose(can.axis, [[0, 0, 0.5], [0, 0, 1]])
    assert box.axis is None
    assert np.linalg.norm([plane.normal for plane in box.planes], axis=1) == pytest.approx(1.0, abs=1e-12)
    assert (len(can.surface.triangles), len(box.surface.triangles)) == (0, 4)


def test_a_malformed_annotation_of_ycb_is_refused_by_line(tmp_path):
    path = write(tmp_path / "symmetries.txt", symmetries(b1="0 0 0\n0 0 0\n0 2 0\n0 0 0\n0 0 0\n"))
    with pytest.raises(FileFormatError, match=r"line 9: .* got length 2"):
        ycb.read_symmetries(path)
    write(path, symmetries().rsplit("\n", 2)[0])
    with pytest.raises(FileFormatError, match=r"expected the axis of 061_foam_brick .* the file ends"):
        ycb.read_symmetries(path)
    write(path, symmetries())
    with pytest.raises(DataAbsentError, match="002_master_chef_can"):
        ycb.load(tmp_path)


def test_a_pose_moves_the_axis_with_the_object(tmp_path):
    for name in ycb.NAMES:
        write(tmp_path / "models" / name / "textured.obj", OBJ)
    write(tmp_path / "symmetries.txt", symmetries())
    can = next(ycb.load(tmp_path)).posed(3)
    # annotated at a height of half a unit, along the edge between the first corner and the last
    bottom, top = can.surface.vertices[[0, 3]]
    np.testing.assert_allclose(can.axis, [(bottom + top) / 2, top - bottom], atol=1e-12)
