"""OBJ, OFF and STL: faces come back as triangles, parts are merged."""

import numpy as np
import pytest

from symjax.io.formats import obj_off_stl
from symjax.io.points import read_points
from tests.helpers.cloud_files import CUBE, QUADS, ascii_stl, binary_stl, put


@pytest.mark.parametrize(
    "data", [binary_stl(CUBE[QUADS[:, :3]]), ascii_stl(CUBE[QUADS[:, :3]])], ids=["binary", "ascii"]
)
def test_stl_triangles_come_back(data):
    back = obj_off_stl.read_stl(data)
    np.testing.assert_array_equal(back.vertices[back.triangles], CUBE[QUADS[:, :3]])


def test_obj_counts_backwards_and_merges_groups(tmp_path):
    square = "v 0 0 {0}\nv 1 0 {0}\nv 1 1 {0}\nv 0 1 {0}\nf -4 -3/1 -2//1 -1/1/1\n"
    text = (
        "mtllib nowhere.mtl\no first\n" + square.format(0) + "g second\nusemtl red\n" + square.format(5) + "v 9 9 9\n"
    )
    solid = obj_off_stl.read_obj(text.encode())
    assert set(solid.vertices[solid.triangles[:2], 2].ravel()) == {0.0}
    assert set(solid.vertices[solid.triangles[2:], 2].ravel()) == {5.0}
    sampled, note = read_points(put(tmp_path, "a.obj", text.encode()), num_samples=100)
    assert "2 faces in 2 parts, merged" in note
    assert "1 loose vertices left out" in note
    assert set(sampled[:, 2].round(9)) == {0.0, 5.0}


def test_solids_of_an_stl_are_merged(tmp_path):
    both = ascii_stl(CUBE[QUADS[:3, :3]], CUBE[QUADS[3:, :3]])
    assert "6 faces in 2 parts, merged" in read_points(put(tmp_path, "a.stl", both)).note
