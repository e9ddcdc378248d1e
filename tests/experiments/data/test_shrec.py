"""The tracks of SHREC 2016 and 2023."""

import json

import numpy as np
import pytest

from experiments.data import shrec2016, shrec2023
from experiments.framework.absence import DataAbsentError
from symjax.errors import FileFormatError
from tests.experiments.data.files import OFF, same, write


def test_shrec2023_clouds_are_loaded_with_their_planes(tmp_path):
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


def test_shrec2016_shapes_have_planes_only_if_annotated(tmp_path):
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
