"""Files: each format returns what was written, and a damaged file raises an error, never a partial cloud."""

import re
import subprocess
import sys

import numpy as np
import pytest

import symjax
from symjax.errors import FileFormatError, InvalidArgumentError, InvalidPointsError
from symjax.io.formats import obj_off_stl, ply
from symjax.io.points import read_points, write_points
from tests.helpers.cloud_files import (
    CLOUDS,
    CUBE,
    MESHES,
    PRISM,
    PRISM_FACES,
    QUADS,
    ascii_ply,
    ascii_stl,
    binary_ply,
    binary_stl,
    npy,
    off,
    put,
)


@pytest.fixture
def points(rng):
    return rng.normal(size=(40, 3)) * [1, 20, 300]


@pytest.mark.parametrize("name", CLOUDS)
def test_a_cloud_is_read_exactly(tmp_path, points, name):
    back, note = read_points(put(tmp_path, name, CLOUDS[name](points)))
    assert back.dtype == np.float64
    np.testing.assert_array_equal(back, points)
    assert note == "cloud of 40 points"


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize(("vertices", "faces"), [(CUBE, QUADS), (PRISM, PRISM_FACES)], ids=["quads", "mixed"])
def test_a_mesh_is_read_as_triangles(name, vertices, faces):
    read = {"ply": ply.read, "off": obj_off_stl.read_off, "obj": obj_off_stl.read_obj}[name.split(".")[1]]
    back = read(MESHES[name](vertices, faces))
    np.testing.assert_array_equal(back.vertices, vertices)
    assert back.num_faces == len(faces)
    assert len(back.triangles) == sum(len(face) - 2 for face in faces)
    # the mesh is closed and consistently oriented, so its signed volume is that of the solid
    corners = back.vertices[back.triangles]
    volume = np.linalg.det(corners).sum() / 6
    assert abs(volume) == pytest.approx(1.0 if vertices is CUBE else 2.0)


@pytest.mark.parametrize("kind", ["ply", "obj", "off", "stl", "stl_ascii"])
def test_agrees_with_trimesh_on_valid_meshes(kind):
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=2)
    data = ball.export(file_type=kind)
    data = data.encode() if isinstance(data, str) else data
    read = {"ply": ply.read, "obj": obj_off_stl.read_obj, "off": obj_off_stl.read_off}.get(kind, obj_off_stl.read_stl)(
        data
    )
    np.testing.assert_allclose(read.vertices[read.triangles], ball.triangles, atol=1e-7)


@pytest.mark.parametrize(
    ("name", "data", "why"),
    [
        ("a.xyz", b"1 2\n3 4\n", r"line 1: expected at least 3 columns \(x y z\), found 2 in '1 2'"),
        ("a.txt", b"1 2 3\n4 five 6\n", "line 2: expected a number in column 2, found 'five'"),
        ("a.txt", b"1x 2 3\n4 5 6\n", "line 1: expected a number in column 1, found '1x'"),
        ("a.csv", b"1,2,3\n4,5\n6,7,8\n", "line 2: expected 3 columns"),
        ("a.csv", b"1,2,3,4\n4,5,6\n", "line 2: expected 4 columns as in line 1, found 3 in '4,5,6'"),
        ("a.csv", b"x,y,z\n", "no points"),
        ("a.txt", b"# nothing\n\n", "no points"),
        ("a.txt", b"\xff\xfe1\x00 \x002\x00", "contains NUL bytes"),
        ("a.obj", b"1 2 3\n4 5 6\n", "no line starts with 'v'"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", "line 3: expected at least 4 columns, found 3 in 'v 0 1'"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "face 1 of 1 refers to vertex 4, .* counted from 1, is 3"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4: expected a vertex index other than 0, found '0'"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "line 4: vertex index -4, but .* is 3"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "2 corners"),
        ("a.off", b"OFF\n-1 0 0\n", "line 2: expected the numbers of vertices, faces and edges, found '-1 0 0'"),
        ("a.off", b"OFF\n0 0 0\n", "no points"),
        ("a.off", b"OFF\n999999999999999999 0 0\n0 0 0\n", r"expected 999999999999999999 \+ 0 rows .* found 1"),
        ("a.off", b"OFF\n2 0 0\n0 0 0\n1 1 1\n2 2 2\n", r"expected 2 \+ 0 rows of vertices and faces .*, found 3"),
        ("a.off", b"4OFF\n1 0 0\n0 0 0 0\n", "does not start with 'OFF'"),
        ("a.stl", b"\0" * 84, "no points"),
        ("a.stl", b"\0" * 80 + b"\xff\xff\xff\xff", "4294967295 triangles"),
        ("a.stl", b"v 0 0 0\n", "not an STL file"),
        ("a.ply", b"v 0 0 0\n", "does not start with 'ply'"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "property 'y'"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex " + b"9" * 5000 + b"\nend_header\n", "line 3: invalid line"),
        ("a.ply", binary_ply(CUBE).replace(b"vertex 8", b"vertex 0", 1)[:-192], "no points"),
        ("a.ply", binary_ply(CUBE).replace(b"vertex 8", b"vertex 7", 1), "24 bytes follow"),
        (
            "a.ply",
            binary_ply(CUBE).replace(b"vertex 8", b"vertex 999999999999999999", 1),
            "found 192 bytes: the file is truncated",
        ),
        ("a.ply", ascii_ply(CUBE).replace(b"vertex 8", b"vertex 5", 1), "expected 5 rows .*, found 8"),
        ("a.ply", ascii_ply(CUBE).replace(b"vertex 8", b"vertex 9", 1), "expected 9 rows .*, found 8"),
        ("a.ply", ascii_ply(CUBE).replace(b"end_header", b"end_headr"), "truncated"),
        ("a.ply", binary_ply(CUBE, [[0, 1, 8]]), "refers to vertex 8, .* counted from 0, is 8"),
        ("a.ply", binary_ply(CUBE, [[0, 1, 2]]).replace(b"uchar", b"float"), "not an integer"),
        ("a.npy", b"\x93NUMPY", "header"),
        ("a.npy", b"PK\x03\x04", "looks like ZIP: unpack it"),
        ("a.npy", npy(CUBE) + b"x", "expected 8 rows .*, found 1 bytes after them"),
        ("a.npy", npy(CUBE.T), r"shape \(3, 8\)"),
        ("a.npy", npy(CUBE + 1j), "complex128"),
        ("a.npy", npy(CUBE.astype(str)), "real numbers"),
        ("a.npy", npy(np.empty((0, 3))), "no points|declares"),
        ("a.npy", npy(np.array([[None] * 3]), allow_pickle=True), "pickled"),
    ],
)
def test_damaged_and_misnamed_files_are_refused(tmp_path, name, data, why):
    path = put(tmp_path, name, data)
    with pytest.raises(FileFormatError, match=why) as caught:
        read_points(path)
    assert str(caught.value).startswith(f"cannot read {str(path)!r}: ")
    assert "\n" not in str(caught.value)


SHORT = CUBE[:5]
FACES = [[0, 1, 2], [1, 2, 3, 4]]
TRUNCATED = {
    "cloud.ply": ascii_ply(SHORT),
    "mesh.ply": ascii_ply(SHORT, FACES),
    "little.ply": binary_ply(SHORT),
    "big.ply": binary_ply(SHORT, FACES, ">"),
    "quads.ply": binary_ply(CUBE, QUADS),
    "cloud.off": off(SHORT),
    "mesh.off": off(SHORT, FACES),
    "binary.stl": binary_stl(CUBE[QUADS[:3, :3]]),
    "ascii.stl": ascii_stl(CUBE[QUADS[:2, :3]]),
    "a.npy": npy(SHORT),
}


@pytest.mark.parametrize("name", TRUNCATED)
def test_a_file_truncated_anywhere_is_refused_or_complete(tmp_path, name):
    """Only a loss in the last number or name can go unnoticed; all points and faces are then still read."""
    data = TRUNCATED[name]
    whole = read_points(put(tmp_path, name, data), num_samples=10)
    refused = 0
    for length in range(len(data)):
        try:
            cut = read_points(put(tmp_path, name, data[:length]), num_samples=10)
        except FileFormatError:
            refused += 1
        else:
            assert cut.note == whole.note
            np.testing.assert_array_equal(cut.points[:4], whole.points[:4])
            assert not data[length:].strip(b".0123456789\n") or data[length:] in b"\nendsolid part\n"
    assert refused >= len(data) - len("endsolid part\n")


@pytest.mark.parametrize("name", TRUNCATED)
def test_flipped_bytes_give_typed_errors_only(tmp_path, name, rng):
    data = np.frombuffer(TRUNCATED[name], np.uint8)
    for _ in range(300):
        damaged = data.copy()
        at = rng.integers(len(data), size=rng.integers(1, 4))
        damaged[at] = rng.integers(256, size=len(at))
        try:
            points = read_points(put(tmp_path, name, damaged.tobytes()), num_samples=10).points
        except FileFormatError:
            continue
        assert points.shape[1] == 3


def test_missing_folder_empty_and_unknown(tmp_path):
    (tmp_path / "folder.ply").mkdir()
    for name, why in [
        ("none.ply", "No such file"),
        ("folder.ply", "it is a folder"),
        (put(tmp_path, "empty.ply", b""), "the file is empty"),
        (put(tmp_path, "a.docx", b"x"), re.escape(".docx' is not supported: use one of PLY, OBJ,")),
        (put(tmp_path, "bare", b"x"), re.escape("'' is not supported: use one of PLY, OBJ,")),
        (put(tmp_path, "swapped.off", binary_ply(CUBE)), "its content looks like PLY: rename it to .ply"),
        (put(tmp_path, "swapped.txt", npy(CUBE)), "its content looks like NPY: rename it to .npy"),
        ("nul\0byte.ply", "cannot read"),
    ]:
        with pytest.raises(FileFormatError, match=why):
            read_points(tmp_path / name)


def test_errors_stay_on_one_line_whatever_the_name(tmp_path):
    with pytest.raises(FileFormatError) as caught:
        read_points(tmp_path / "two\nlines\x1b[31m.ply")
    assert "\n" not in str(caught.value)
    assert "\x1b" not in str(caught.value)


def test_number_of_samples_and_seed_are_checked(tmp_path):
    path = put(tmp_path, "a.off", off(CUBE, QUADS))
    for num_samples in (0, "a", 1.5):
        with pytest.raises(InvalidArgumentError, match="num_samples"):
            read_points(path, num_samples=num_samples)
    for rng in (-1, "a"):
        with pytest.raises(InvalidArgumentError, match="rng must be a seed"):
            read_points(path, rng=rng)
    with pytest.raises(InvalidArgumentError, match="a path must be text"):
        read_points(5)


def test_written_points_are_read_exactly(tmp_path, points):
    path = tmp_path / "out.ply"
    write_points(path, points)
    np.testing.assert_array_equal(symjax.read_points(path).points, points)
    assert [file.name for file in tmp_path.iterdir()] == ["out.ply"]


def test_writing_is_refused_rather_than_wrong(tmp_path, points):
    path = tmp_path / "out.ply"
    write_points(path, points)
    with pytest.raises(InvalidArgumentError, match="it exists; pass force=True"):
        write_points(path, points[:3])
    assert len(read_points(path).points) == len(points)
    write_points(path, points[:3], force=True)
    assert len(read_points(path).points) == 3
    with pytest.raises(InvalidArgumentError, match=r"the name must end in \.ply"):
        write_points(tmp_path / "out.obj", points)
    with pytest.raises(InvalidArgumentError, match="No such file"):
        write_points(tmp_path / "nowhere" / "out.ply", points)
    with pytest.raises(InvalidPointsError, match=r"shape \(n, 3\)"):
        write_points(tmp_path / "new.ply", points.T)


def test_importing_the_reader_imports_no_large_library():
    code = "import sys, symjax.io.points; sys.exit(bool({'jax', 'scipy', 'trimesh'} & sys.modules.keys()))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_real_models_are_read(models):
    for name in ("spot.obj", "human_woman.off", "face.ply"):
        sampled, note = read_points(models / name, num_samples=1000)
        assert sampled.shape == (1000, 3)
        assert note.startswith("mesh of ")
