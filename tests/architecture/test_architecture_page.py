"""docs/architecture.md and its picture say what the import contracts say."""

import importlib.util
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.fixture(scope="module")
def architecture():
    spec = importlib.util.spec_from_file_location("architecture", DOCS / "architecture.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_picture_is_what_its_script_writes(architecture):
    assert architecture.PICTURE.read_text(encoding="utf-8") == architecture.picture()


def test_a_package_without_a_box_is_an_error(architecture, monkeypatch):
    monkeypatch.delitem(architecture.SYMJAX.boxes, "viz")
    with pytest.raises(ValueError, match=r"differ: \['viz'\]"):
        architecture.picture()


def test_every_arrow_ends_at_its_packages(architecture):
    for panel in architecture.PANELS:
        for flow in panel.flows:
            for end in (flow.source, flow.target):
                boxes = [panel.boxes[name] for name in end.split("|")]
                assert min(box.left for box in boxes) < flow.x < max(box.right for box in boxes), flow


def test_the_script_writes_the_last_column_of_the_tables(architecture):
    text = architecture.PAGE.read_text(encoding="utf-8")
    assert architecture.with_imports(text) == text
    assert architecture.with_imports(text.replace("`io`, `geometry`, `errors` |", "|")) == text


@pytest.mark.parametrize("package", ["symjax", "experiments"])
def test_the_tables_list_what_each_package_may_import(architecture, package):
    text = (DOCS / "architecture.md").read_text(encoding="utf-8")
    section = re.search(rf"^## {package}\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)[1]
    table = {
        name: re.findall(r"`(\w+)`", imports)
        for name, imports in re.findall(r"^\| `(\w+)` \|.*\| ([^|]*) \|$", section, re.MULTILINE)
    }
    layers = architecture.layers_of(package)
    lower = {
        name: [below for others in layers[row + 1 :] for below in others]
        for row, layer in enumerate(layers)
        for name in layer
    }
    assert table == lower
