"""The rooms of the house stay small: few files in a folder, no long file, tests where the code is."""

from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]

MOST_FILES, MOST_LINES = 14, 300
"""Files of code in a folder, and lines in a file."""

ONE_FILE_A_METHOD = Path("experiments/baselines")

OF_SEVERAL_MODULES = {Path("l2e/derivatives"), Path("l2e/sweeps")}
"""Folders of unit tests about what several modules of a package do together."""

TREES = ("symjax", "experiments", "tests")

FILES = sorted(path.relative_to(PROJECT) for tree in TREES for path in (PROJECT / tree).rglob("*.py"))


def test_no_folder_has_too_many_files():
    counts: dict[Path, int] = {}
    for path in FILES:
        counts[path.parent] = counts.get(path.parent, 0) + 1
    assert {str(f): n for f, n in counts.items() if n > MOST_FILES and f != ONE_FILE_A_METHOD} == {}


def test_no_file_is_too_long():
    lengths = {str(path): (PROJECT / path).read_text(encoding="utf-8").count("\n") for path in FILES}
    assert {path: length for path, length in lengths.items() if length > MOST_LINES} == {}


def test_the_package_has_no_loose_files():
    loose = {path.name for path in (PROJECT / "symjax").iterdir() if path.is_file()}
    assert loose == {"__init__.py", "errors.py", "py.typed"}


@pytest.mark.parametrize("path", [p for p in FILES if p.parts[:2] == ("tests", "unit")], ids=str)
def test_a_unit_test_stands_under_the_name_of_its_package(path):
    package = path.parent.relative_to("tests/unit")
    assert package in OF_SEVERAL_MODULES or (PROJECT / "symjax" / package / "__init__.py").is_file()


def test_every_file_says_what_it_is():
    for path in FILES:
        if path.parts[0] != "tests":
            assert (PROJECT / path).read_text(encoding="utf-8").lstrip().startswith('"""'), path
