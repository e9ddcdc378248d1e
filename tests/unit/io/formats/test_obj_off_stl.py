"""OBJ, OFF and STL: faces become triangles, and parts are merged."""

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io.formats import obj_off_stl
from symjax.io.points import read_points
from tests.helpers.cloud_files import CUBE, QUADS, ascii_stl, binary_stl, put


@pytest.mark.parametrize(
    "data", [binary_stl(CUBE[QUADS[:, :3]]), ascii_stl(CUBE[QUADS[:, :3]])], ids=["binary", "ascii"]
)
def test_stl_triangles_are_read(data):
    back = obj_off_stl.read_stl(data)
    np.testing.assert_array_equal(back.vertices[back.triangles], CUBE[QUADS[:, :3]])


def test_obj_has_relative_indices_and_groups_that_are_merged(tmp_path):
    square = "v 0 0 {0}\nv 1 0 {0}\nv 1 1 {0}\nv 0 1 {0}\nf -4 -3/1 -2//1 -1/1/1\n"
    text = (
        "mtllib nowhere.mtl\no first\n" + square.format(0) + "g second\nusemtl red\n" + square.format(5) + "v 9 9 9\n"
    )
    solid = obj_off_stl.read_obj(text.encode())
    assert set(solid.vertices[solid.triangles[:2], 2].ravel()) == {0.0}
    assert set(solid.vertices[solid.triangles[2:], 2].ravel()) == {5.0}
    sampled, note = read_points(put(tmp_path, "a.obj", text.encode()), num_samples=100)
    assert "2 faces in 2 parts, merged" in note
    assert "unused vertices ignored: 1" in note
    assert set(sampled[:, 2].round(9)) == {0.0, 5.0}


def test_solids_of_an_stl_are_merged(tmp_path):
    both = ascii_stl(CUBE[QUADS[:3, :3]], CUBE[QUADS[3:, :3]])
    assert "6 faces in 2 parts, merged" in read_points(put(tmp_path, "a.stl", both)).note


def test_obj_lines_continue_after_a_backslash_and_errors_count_the_lines_of_the_file():
    text = b"v 0 0 0\nv 1 \\\n0 0\nv 0 1 0\r\nf 1 2 \\\r\n3\n"
    assert obj_off_stl.read_obj(text).triangles.tolist() == [[0, 1, 2]]
    with pytest.raises(FileFormatError, match="line 7: expected a vertex index other than 0, found 'x'"):
        obj_off_stl.read_obj(text + b"f 1 2 x\n")
    with pytest.raises(FileFormatError, match="line 5: expected a vertex index"):
        obj_off_stl.read_obj(text.removesuffix(b"\r\n3\n"))
