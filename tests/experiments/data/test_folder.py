"""A folder of meshes with a listing of planes."""

import json

import pytest

from experiments.data import folder
from symjax.errors import FileFormatError
from tests.experiments.data.files import OBJ, OFF, same, write


def test_a_listing_gives_planes_and_groups(tmp_path):
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
        ('{"a":\n {"file" "a.off"}}', "line 2: not JSON"),
        ("[]", "expected a JSON object .* got list"),
        ('{"a": {"normal": [1, 0, 0], "offset": 0}}', "entry 'a': \"file\" is missing"),
        ('{"a": {"file": "a.off"}}', 'entry \'a\': "planes" or "normal" is missing'),
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
    with pytest.raises(FileFormatError, match=r"a\.off: expected"):
        next(folder.load(tmp_path))


def test_the_real_models_are_a_folder(models):
    first = next(folder.load(models.parent))
    assert (first.name, first.group) == ("boat", "exact")
    assert same(first.planes[0], [1, 0, 0], -3.255837)
