"""Folders have few files, files are short, and unit tests mirror the packages."""

from pathlib import Path

import pytest

PROJECT = Path(__file__).resolve().parents[2]

MOST_FILES, MOST_LINES = 14, 300
"""Largest number of Python files in a folder, and of lines in a file."""

ONE_FILE_PER_METHOD = Path("experiments/baselines")

TESTS_OF_SEVERAL_MODULES = {Path("l2e/derivatives"), Path("l2e/sweeps")}
"""Folders of unit tests of several modules of a package together."""

TREES = ("symjax", "experiments", "tests")

FILES = sorted(path.relative_to(PROJECT) for tree in TREES for path in (PROJECT / tree).rglob("*.py"))


def test_no_folder_has_too_many_files():
    counts: dict[Path, int] = {}
    for path in FILES:
        counts[path.parent] = counts.get(path.parent, 0) + 1
    assert {str(f): n for f, n in counts.items() if n > MOST_FILES and f != ONE_FILE_PER_METHOD} == {}


def test_no_file_is_too_long():
    lengths = {str(path): (PROJECT / path).read_text(encoding="utf-8").count("\n") for path in FILES}
    assert {path: length for path, length in lengths.items() if length > MOST_LINES} == {}


def test_the_root_of_the_package_has_no_other_files():
    loose = {path.name for path in (PROJECT / "symjax").iterdir() if path.is_file()}
    assert loose == {"__init__.py", "errors.py", "py.typed"}


@pytest.mark.parametrize("path", [p for p in FILES if p.parts[:2] == ("tests", "unit")], ids=str)
def test_a_unit_test_is_in_the_folder_of_its_package(path):
    package = path.parent.relative_to("tests/unit")
    assert package in TESTS_OF_SEVERAL_MODULES or (PROJECT / "symjax" / package / "__init__.py").is_file()


def test_every_file_has_a_module_docstring():
    for path in FILES:
        if path.parts[0] != "tests":
            assert (PROJECT / path).read_text(encoding="utf-8").lstrip().startswith('"""'), path
