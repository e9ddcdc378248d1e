"""The worked examples of CONTRIBUTING.md are complete: applied to a copy of the project, their tests pass."""

import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

PROJECT = Path(__file__).resolve().parents[2]
TEXT = (PROJECT / "CONTRIBUTING.md").read_text(encoding="utf-8")

EXISTING = (
    "tests/architecture/test_architecture_page.py",
    "tests/architecture/test_docstrings.py",
    "tests/architecture/test_imports.py",
    "tests/architecture/test_file_layout.py",
    "tests/cli/test_detect.py",
    "tests/experiments/baselines/test_baseline.py",
    "tests/experiments/comparison/test_leaderboard.py",
    "tests/experiments/framework/test_run.py",
    "tests/experiments/studies/test_studies.py",
)
ABOUT = (
    "architecture_page",
    "every_named_method",
    "exhaustive",
    "skewness",
    "mean_offset",
    "layer",
    "rooms",
    "leaderboard",
    "catalogue",
    "both_sizes",
    "run_here",
)
"""Files of tests that additions have to pass, too, and words in the names of those that are about them."""

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="the runner of experiments/ needs Linux or macOS")


class Block(NamedTuple):
    """A block of code that is a file, or a change of one; `before` is the paragraph above it."""

    kind: str
    path: str
    code: str
    before: str


def blocks():
    found = re.finditer(r"^```(\w+) file=(\S+)\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)
    return [Block(*match.groups(), TEXT[: match.start()].rstrip().rpartition("\n\n")[2]) for match in found]


def changed(text, block):
    """A text after a change; every part of it must fit exactly one place."""
    for part in block.code.split("@@\n"):
        old = "".join(line[1:] for line in part.splitlines(True) if line[0] in " -")
        new = "".join(line[1:] for line in part.splitlines(True) if line[0] in " +")
        assert f"\n{text}".count(f"\n{old}") == 1, (
            f"CONTRIBUTING.md, block of {block.path}: these lines must be in the file exactly once. If the file has "
            f"changed, change the lines without + in the block too:\n{old}"
        )
        text = f"\n{text}".replace(f"\n{old}", f"\n{new}")[1:]
    return text


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the project with all examples applied."""
    folder = tmp_path_factory.mktemp("project")
    ignored = shutil.ignore_patterns("__pycache__", "small")
    for name in ("symjax", "experiments", "tests", "notebooks", "docs"):
        shutil.copytree(PROJECT / name, folder / name, ignore=ignored)
    for name in ("pyproject.toml", "conftest.py", "README.md", "CONTRIBUTING.md"):
        shutil.copy(PROJECT / name, folder / name)
    for block in blocks():
        path = folder / block.path
        if block.kind == "diff":
            path.write_text(changed(path.read_text(encoding="utf-8"), block), encoding="utf-8")
        else:
            assert not path.exists()
            path.parent.mkdir(exist_ok=True)
            path.write_text(block.code, encoding="utf-8")
    python(folder, "docs/architecture.py")
    return folder


def python(folder, *arguments):
    done = subprocess.run([sys.executable, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_there_is_an_example_of_each_with_its_test():
    titles = re.findall(r"^### An? (.*)$", TEXT, re.MULTILINE)
    assert set(titles) == {"method", "baseline", "metric", "study", "file format"}
    for section in re.split(r"^### ", TEXT, flags=re.MULTILINE)[1:]:
        (path,) = re.findall(r"^```python file=(tests/\S*/test_\w+\.py)$", section, re.MULTILINE)
        (command,) = re.findall(r"^pytest -n 0 .*$", section, re.MULTILINE)[:1]
        assert any(path.startswith(argument) for argument in command.split()[3:]), command
        for argument in re.findall(r"^pytest -n 0 (.*?)(?: -k.*)?$", section, re.MULTILINE):
            for name in argument.split():
                assert (PROJECT / name).exists() or name in {path, str(Path(path).parent), "symjax/exhaustive"}, name


def test_a_block_that_does_not_fit_its_file_is_named():
    block = Block("diff", "symjax/io/points.py", " a\n+b\n", "")
    assert changed("x\na\n", block) == "x\na\nb\n"
    for text in ("x\n", "a\nx\na\n"):
        with pytest.raises(AssertionError, match=r"CONTRIBUTING\.md, block of symjax/io/points\.py"):
            changed(text, block)


def test_every_block_is_introduced_by_the_name_of_its_file():
    for block in blocks():
        assert f"`{block.path}`" in block.before, block.path


def test_the_examples_pass_their_tests_and_those_of_the_project(copy):
    own = [block.path for block in blocks() if block.kind == "python" and block.path.startswith("tests/")]
    about = " or ".join([*ABOUT, *(Path(path).stem for path in own)])
    options = ("-m", "pytest", "-n", "0", "-p", "no:cacheprovider", "-k", about)
    assert len(own) == 5
    assert "passed" in python(copy, *options, *own, "symjax/exhaustive", *EXISTING)


def test_the_examples_follow_the_conventions(copy):
    pytest.importorskip("importlinter", reason="the linters are in the extra dev")
    written = [block.path for block in blocks()]
    python(copy, "-m", "ruff", "check", *(path for path in written if path.endswith((".py", ".toml"))))
    python(copy, "-m", "ruff", "format", "--check", *(path for path in written if path.endswith(".py")))
    done = subprocess.run(["lint-imports", "--no-cache"], cwd=copy, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.slow
def test_the_types_of_the_examples_are_checked(copy):
    pytest.importorskip("mypy", reason="the linters are in the extra dev")
    python(copy, "-m", "mypy")


def test_the_commands_of_the_examples_run(copy):
    python(copy, "-m", "experiments.run", "mean_offset", "--size", "small", "--out", "results")
    python(copy, "-m", "experiments.run", "page")
    assert "`mean_offset` (not run)" in (copy / "experiments" / "README.md").read_text(encoding="utf-8")
