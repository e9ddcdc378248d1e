"""The loaders on small files in the published formats, and the generated benchmark."""

import json

import numpy as np
import pytest
from scipy.io import savemat

from experiments.comparison import objects
from experiments.data import folder, funk, procedural, shapenet, shrec2016, shrec2023, ycb
from experiments.data.absence import DataAbsentError
from experiments.data.numberfile import NumberFile
from experiments.data.shape import cases
from experiments.metrics import patch
from symjax.datasets import KINDS
from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.geometry.plane import Plane

OFF = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""
TABLE = """2
0 -3.61376 -1.39425
0 -3.61376 1.39425
0 3.61376 -1.39425
5.19097
-2.59548 0 -1.39425
2.59548 0 -1.39425
-2.59548 0 1.39425
7.22751
"""
LOADERS = (folder.load, funk.load, shapenet.load, shrec2016.load, shrec2023.load, ycb.load)


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def same(plane, normal, offset):
    """Whether a plane is another, whatever the sign."""
    n, w = plane.canonical()
    other = Plane(np.array(normal, float), np.asarray(float(offset))).canonical()
    return np.allclose(n, other.normal, atol=1e-9) and np.allclose(w, other.offset, atol=1e-9)


@pytest.mark.parametrize("load", LOADERS)
def test_absent_data_is_refused_at_once_with_instructions(load, tmp_path):
    with pytest.raises(DataAbsentError, match=r"(?s)DATA IS ABSENT: no .*nowhere.*ay (it|them) out as\n  FOLDER/"):
        load(tmp_path / "nowhere")


@pytest.mark.parametrize("load", [funk.load, shrec2023.load])
def test_an_empty_folder_is_absent_data(load, tmp_path):
    with pytest.raises(DataAbsentError, match="ay it out as"):
        load(tmp_path)


def test_funk(tmp_path):
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


def test_rectangles_of_funk_go_with_their_shape_into_a_pose(tmp_path):
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
    whole = objects.entrant("funk", str(tmp_path), 0, 4, 2)
    np.testing.assert_array_equal(whole.truths.centres, after.centres)


def test_funk_gives_the_rectangles_of_a_file(tmp_path):
    rectangles = funk.read_planes(write(tmp_path / "table-plane.txt", TABLE))
    assert rectangles.extents.tolist() == [5.19097, 7.22751]
    assert patch.from_corners(rectangles.corners).centres == pytest.approx(np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("two\n", 1, "the number of planes"),
        ("1\n0 0 0\n0 1\n0 0 1\n3\n", 3, "a corner"),
        ("1\n0 0 0\n0 1 x\n0 0 1\n3\n", 3, "a corner"),
        ("1\n0 0 0\n0 nan 0\n0 0 1\n3\n", 3, "a corner"),
        ("1\n\n0 0 0\n0 1 0\n0 2 0\n3\n", 5, "one line"),
        ("1\n0 0 0\n0 1 0\n0 0 1\n", 4, "the file ends"),
        ("1\n0 0 0\n0 1 0\n0 0 1\n3\n4\n", 6, "should end"),
        ("", 1, "the file ends"),
    ],
)
def test_a_malformed_file_of_funk_is_refused_by_line(text, line, message, tmp_path):
    path = write(tmp_path / "bad-plane.txt", text)
    with pytest.raises(FileFormatError, match=rf"bad-plane\.txt, line {line}: .*{message}"):
        funk.read_planes(path)


def test_funk_refuses_models_and_planes_that_do_not_pair(tmp_path):
    write(tmp_path / "one-plane.txt", "0\n")
    write(tmp_path / "two.ply", PLY)
    with pytest.raises(FileFormatError, match="1 models without planes, 1 the reverse: 'two'"):
        funk.load(tmp_path)
    write(tmp_path / "two.off", OFF)
    with pytest.raises(FileFormatError, match="2 model files, and only 1 names"):
        funk.load(tmp_path)


def a_shapenet(tmp_path, cells, ids="a1 3,1\nb2 1\n"):
    write(tmp_path / "1000.txt", ids)
    savemat(tmp_path / "gt_planes.mat", {"gt_planes": cells})


def cell_array(rows):
    cells = np.empty((len(rows), 3), object)
    for i, row in enumerate(rows):
        for j in range(3):
            cells[i, j] = np.array([row[j]] if j < len(row) else [])
    return cells


def test_shapenet(tmp_path):
    near = [np.cos(0.05), np.sin(0.05), 0.0, 0.0]
    a_shapenet(tmp_path, cell_array([[[2.0, 0, 0, -1.0], near, [0, 1, 0, 0.25]], [[0.0, 0, 0, 0], [0, 0, 1, 0]]]))
    write(tmp_path / "ShapeNetCore.v2" / "02691156" / "a1" / "models" / "model_normalized.obj", OBJ)
    write(tmp_path / "objs" / "b2.obj", OBJ)
    a, b = shapenet.load(tmp_path)
    assert (a.name, len(a.planes), b.name, len(b.planes)) == ("a1", 2, "b2", 1)
    # ax + by + cz + d = 0
    assert same(a.planes[0], [1, 0, 0], 0.5)
    assert same(a.planes[1], [0, 1, 0], -0.25)
    assert same(b.planes[0], [0, 0, 1], 0)
    assert len(a.surface.triangles) == 4


def test_shapenet_says_which_models_are_missing(tmp_path):
    a_shapenet(tmp_path, cell_array([[[1.0, 0, 0, 0]], [[1.0, 0, 0, 0]]]))
    with pytest.raises(DataAbsentError, match="2 of 2 models"):
        shapenet.load(tmp_path, allow_missing=True)
    write(tmp_path / "objs" / "b2.obj", OBJ)
    with pytest.raises(DataAbsentError, match=r"1 of 2 models .* the first a1"):
        shapenet.load(tmp_path)
    assert [shape.name for shape in shapenet.load(tmp_path, allow_missing=True)] == ["b2"]


def test_shapenet_refuses_what_does_not_fit(tmp_path):
    a_shapenet(tmp_path, cell_array([[[1.0, 0, 0, 0]]]))
    with pytest.raises(FileFormatError, match=r"lists 2 models, .* planes for 1"):
        shapenet.load(tmp_path)
    a_shapenet(tmp_path, cell_array([[[1.0, 0, 0, 0]], [[1.0, 0]]]))
    with pytest.raises(FileFormatError, match=r"gt_planes\.mat, row 2"):
        shapenet.load(tmp_path)
    a_shapenet(tmp_path, np.eye(4))
    with pytest.raises(FileFormatError, match="no cell array"):
        shapenet.load(tmp_path)
    write(tmp_path / "gt_planes.mat", "text")
    with pytest.raises(FileFormatError, match=r"gt_planes\.mat: no MAT file"):
        shapenet.load(tmp_path)
    write(tmp_path / "1000.txt", "a1 3,1\n../b2 1\n")
    with pytest.raises(FileFormatError, match=r"1000\.txt, line 2"):
        shapenet.load(tmp_path)


def test_shrec2023(tmp_path):
    for number in (10, 9):
        write(tmp_path / f"points{number}.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
        write(tmp_path / f"points{number}_sym.txt", "2\n2 0 0 0.5 7 7\n0 0 -1 0 0 0.25\n")
    write(tmp_path / "points9_res.txt", "0\n")
    nine, ten = shrec2023.load(tmp_path)
    assert (nine.name, ten.name) == ("points9", "points10")
    assert same(nine.planes[0], [1, 0, 0], 0.5)
    assert same(nine.planes[1], [0, 0, 1], 0.25)
    assert len(nine.surface.triangles) == 0
    assert sorted(map(tuple, nine.points(10, np.random.default_rng(0)))) == sorted(map(tuple, nine.surface.vertices))


@pytest.mark.parametrize(
    ("text", "line"), [("1\n1 0 0 0 0\n", 2), ("2\n1 0 0 0 0 0\n", 2), ("1\n0 0 0 1 1 1\n", 2), ("1.5\n", 1)]
)
def test_a_malformed_file_of_shrec2023_is_refused_by_line(text, line, tmp_path):
    with pytest.raises(FileFormatError, match=rf"points1_sym\.txt, line {line}: "):
        shrec2023.read_planes(write(tmp_path / "points1_sym.txt", text))


def test_shrec2023_needs_planes_for_every_cloud(tmp_path):
    write(tmp_path / "points1.txt", "0 0 0\n1 0 0\n")
    with pytest.raises(DataAbsentError, match=r"points1_sym\.txt"):
        shrec2023.load(tmp_path)


def test_shrec2016(tmp_path):
    write(tmp_path / "cuts" / "cuts_cat_shape_1.off", OFF)
    write(tmp_path / "cuts" / "cuts_cat_shape_2.off", OFF)
    assert [(shape.name, shape.planes) for shape in shrec2016.load(tmp_path)] == [
        ("cuts_cat_shape_1", ()),
        ("cuts_cat_shape_2", ()),
    ]
    listing = {"cuts_cat_shape_2": {"file": "cuts/cuts_cat_shape_2.off", "normal": [0, 0, 1], "offset": 0.5}}
    write(tmp_path / "planes.json", json.dumps(listing))
    one, two = shrec2016.load(tmp_path)
    assert one.planes == ()
    assert same(two.planes[0], [0, 0, 1], 0.5)
    with pytest.raises(DataAbsentError, match="holes"):
        shrec2016.load(tmp_path, "holes")


def symmetries(**blocks):
    """An annotation of all objects: a can, and by number what is given."""
    can = "0 0 0.5\n0 0.6 0.8\n0 0 0\n0 0 0\n0 0 1\n"
    return "\n".join(blocks.get(f"b{k}", can) for k in range(len(ycb.NAMES)))


def test_ycb(tmp_path):
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
    with pytest.raises(FileFormatError, match="line 9: a direction of length 2"):
        ycb.read_symmetries(path)
    write(path, symmetries().rsplit("\n", 2)[0])
    with pytest.raises(FileFormatError, match="the axis of 061_foam_brick was expected"):
        ycb.read_symmetries(path)
    write(path, symmetries())
    with pytest.raises(DataAbsentError, match="002_master_chef_can"):
        ycb.load(tmp_path)


def test_a_folder_of_any_meshes(tmp_path):
    write(tmp_path / "models" / "a.off", OFF)
    write(tmp_path / "b.obj", OBJ)
    listing = {
        "a": {"file": "models/a.off", "normal": [0, 3, 0], "offset": 1.5, "kind": "exact: by hand"},
        "b": {
            "file": "b.obj",
            "planes": [{"normal": [1, 0, 0], "offset": 0}, {"normal": [0, 0, 1], "offset": 1}],
        },
        "c": {"file": "b.obj", "normal": None, "kind": "none"},
    }
    write(tmp_path / "planes.json", json.dumps(listing))
    a, b, c = folder.load(tmp_path)
    assert (a.group, len(b.planes), c.planes) == ("exact", 2, ())
    assert same(a.planes[0], [0, 1, 0], 0.5)
    assert same(b.planes[1], [0, 0, 1], 1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('{"a":\n {"file" "a.off"}}', "line 2: no JSON"),
        ("[]", "an object of entries"),
        ('{"a": {"normal": [1, 0, 0], "offset": 0}}', "entry 'a': no \"file\""),
        ('{"a": {"file": "a.off"}}', "entry 'a': neither"),
        ('{"a": {"file": "a.off", "normal": [1, 0], "offset": 0}}', "entry 'a': a plane needs"),
        ('{"a": {"file": "a.off", "normal": [0, 0, 0], "offset": 0}}', "entry 'a': a plane needs"),
        ('{"a": {"file": "a.off", "planes": [{"normal": [1, 0, 0]}]}}', "entry 'a': a plane needs"),
    ],
)
def test_a_malformed_listing_is_refused_by_line_or_entry(text, message, tmp_path):
    write(tmp_path / "planes.json", text)
    with pytest.raises(FileFormatError, match=rf"planes\.json, {message}|planes\.json: {message}"):
        folder.load(tmp_path)


def test_a_damaged_model_is_named(tmp_path):
    write(tmp_path / "a.off", OFF[:40])
    write(tmp_path / "planes.json", '{"a": {"file": "a.off", "normal": null}}')
    with pytest.raises(FileFormatError, match=r"a\.off: the header promises"):
        next(folder.load(tmp_path))


def test_binary_content_is_named(tmp_path):
    path = tmp_path / "a-plane.txt"
    path.write_bytes(b"1\0")
    with pytest.raises(FileFormatError, match=r"a-plane\.txt: binary"):
        NumberFile(path)


def test_the_real_models_are_a_folder(models):
    first = next(folder.load(models.parent))
    assert (first.name, first.group) == ("boat", "exact")
    assert same(first.planes[0], [1, 0, 0], -3.255837)


def test_planes_go_with_their_shape_into_a_pose(tmp_path):
    write(tmp_path / "a.off", OFF)
    # the tetrahedron is its own mirror image in x = y
    listing = {"a": {"file": "a.off", "normal": [1, -1, 0], "offset": 0, "kind": "exact"}}
    write(tmp_path / "planes.json", json.dumps(listing))
    (shape,) = folder.load(tmp_path)
    one, two = cases([shape], 200, 2)
    assert (one.name, one.seed, two.seed) == ("a", 0, 1)
    assert not np.allclose(one.points, two.points)
    for seed, case in enumerate((one, two)):
        posed = shape.posed(seed)
        images = case.planes[0].reflect(posed.surface.vertices)
        distances = np.linalg.norm(images[:, None] - posed.surface.vertices, axis=2).min(axis=1)
        np.testing.assert_allclose(distances, 0, atol=1e-12)
        assert case.diagonal == pytest.approx(np.sqrt(3))
        np.testing.assert_array_equal(shape.case(200, seed).points, case.points)


def test_an_axis_goes_into_a_pose(tmp_path):
    for name in ycb.NAMES:
        write(tmp_path / "models" / name / "textured.obj", OBJ)
    write(tmp_path / "symmetries.txt", symmetries())
    can = next(ycb.load(tmp_path)).posed(3)
    # annotated at a height of half a unit, along the edge between the first corner and the last
    bottom, top = can.surface.vertices[[0, 3]]
    np.testing.assert_allclose(can.axis, [(bottom + top) / 2, top - bottom], atol=1e-12)


def test_the_generated_benchmark_does_not_depend_on_the_order():
    benchmark = procedural.Procedural(num_points=100)
    late = benchmark.case(5)
    early = list(benchmark.cases(6))[5]
    assert (late.name, late.seed) == (early.name, early.seed)
    np.testing.assert_array_equal(late.points, early.points)


def test_the_generated_benchmark_has_1354_objects_of_kinds_with_planes():
    benchmark = procedural.Procedural(num_points=50)
    last = benchmark.case(procedural.NUM_OBJECTS - 1)
    assert len(last.planes) >= 1
    for k in (-1, 1354):
        with pytest.raises(InvalidArgumentError, match="0 to 1353"):
            benchmark.case(k)
    shares = [KINDS[kind].symmetry for kind in procedural.PROCEDURAL_KINDS]
    assert set(shares) == {"single", "multiple"}
    assert "funk" not in procedural.NAME


def test_another_seed_gives_other_objects():
    one, other = (procedural.Procedural(seed, 50).case(7) for seed in (1, 2))
    assert one.name == other.name
    assert one.diagonal != other.diagonal
