"""The house: data flows one way, and importing symjax is cheap and leaves everything as it was."""

import ast
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import symjax

ROOT = Path(symjax.__file__).parent

# where no JAX is; the estimator; and what stands on both
WITHOUT_JAX = (
    *("points", "cloud", "outliers", "floor", "frames", "stages", "finding", "uncertainty", "asymmetry"),
    *("robust.surface", "robust.viewpoint", "robust.lattice", "robust.hypotheses", "robust.evidence", "robust.patches"),
    *("symhks.spectrum", "symhks.signatures", "symhks.keypoints", "symhks.matching", "symhks.correspondences"),
)
ESTIMATOR = (
    *("sphere", "objective", "features", "criterion", "jacobi", "implicit", "initial", "pairs", "problem", "screening"),
    *("answer", "scale", "fit", "fitting", "sweeping", "solvers.linesearch", "solvers.bfgs", "solvers.alternation"),
    *("solvers.newton", "solvers.reweighting", "solvers.solver", "solvers.lanes", "solvers.names"),
)
BRIDGE = (
    *("pipeline", "detection", "robust.registration", "robust.search", "robust.polish", "robust.method"),
    *("symhks.search", "symhks.method"),
)


def imported(path):
    """Modules of symjax that a file imports when it is itself imported, without the leading `symjax.`."""
    names = set()
    pending = list(ast.parse(path.read_text(encoding="utf-8")).body)
    while pending:
        node = pending.pop()
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "symjax":
            tail = node.module.split(".")[1:]
            names |= {".".join(tail)} if tail else {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            names |= {alias.name.removeprefix("symjax.") for alias in node.names if alias.name.startswith("symjax.")}
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            pending += node.orelse
    return names


def path_of(name):
    return ROOT / f"{name.replace('.', '/')}.py"


@pytest.mark.parametrize("name", WITHOUT_JAX)
def test_nothing_before_the_pairs_knows_the_estimator(name):
    assert not imported(path_of(name)) & {*ESTIMATOR, *BRIDGE}


@pytest.mark.parametrize("name", ESTIMATOR)
def test_the_estimator_knows_no_clouds(name):
    assert not imported(path_of(name)) & {*WITHOUT_JAX, *BRIDGE}


def test_the_package_imports_neither_experiments_nor_notebooks():
    for path in ROOT.rglob("*.py"):
        assert "import experiments" not in path.read_text(encoding="utf-8")
        assert "from experiments" not in path.read_text(encoding="utf-8")


def run(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


@pytest.mark.parametrize(
    "name", ["symjax", "symjax.cli", *(f"symjax.{name}" for name in WITHOUT_JAX), "symjax.datasets"]
)
def test_no_jax_is_imported_before_it_is_needed(name):
    assert run(f"import sys, {name}; print('jax' in sys.modules)") == "False"


def test_importing_everything_leaves_flags_seeds_and_threads_alone():
    code = """
import os, numpy as np, jax
np.random.seed(3)
before = (jax.config.jax_enable_x64, np.random.get_state()[1].tolist(), dict(os.environ))
import symjax
[getattr(symjax, name) for name in symjax.__all__]
after = (jax.config.jax_enable_x64, np.random.get_state()[1].tolist(), dict(os.environ))
print(before == after)
"""
    assert run(code) == "True"


def test_every_public_name_is_there_and_documented():
    for _ in range(2):
        for name in symjax.__all__:
            found = getattr(symjax, name)
            assert found.__doc__
            assert isinstance(found, ModuleType) == (name in ("metrics", "samples"))
    # a function that shares its name with a module would be replaced by it
    assert callable(symjax.detect)
    assert callable(symjax.load)
    with pytest.raises(AttributeError, match="nothing"):
        symjax.nothing  # noqa: B018
