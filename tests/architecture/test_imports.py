"""Packages that do not need JAX do not import it, and the layers of pyproject.toml hold (import-linter)."""

import importlib.util
import pkgutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import symjax

ROOT = Path(symjax.__file__).parent
PROJECT = ROOT.parent

WITHOUT_JAX = ("geometry", "io", "preprocess", "datasets", "detection", "method", "viz", "cli", "robust", "symhks")

NEED_JAX = {
    *("symjax.robust.registration", "symjax.robust.search", "symjax.robust.refinement"),
    "symjax.symhks.plane_fit",
}
"""Modules of those packages that use JAX. The methods import them when they are called."""


def modules_of(package):
    return [
        module.name
        for module in pkgutil.walk_packages([str(ROOT / package)], f"symjax.{package}.")
        if module.name not in NEED_JAX and not module.name.endswith("__main__")
    ]


@pytest.mark.core
@pytest.mark.parametrize("package", ["", *WITHOUT_JAX])
def test_no_jax_is_imported_before_it_is_needed(package):
    names = modules_of(package) if package else ["symjax"]
    assert names
    code = f"import importlib, sys; [importlib.import_module(n) for n in {names!r}]; print('jax' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=PROJECT)
    assert done.stdout.strip() == "False"


def test_the_statuses_do_not_import_jax():
    code = "import sys; from symjax.l2e.status import Status; print(Status(0).sentence, 'jax' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=PROJECT)
    assert done.stdout.startswith("Converged")
    assert done.stdout.strip().endswith("False")


def test_every_package_has_a_layer():
    settings = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    layers = next(c["layers"] for c in contracts if c["type"] == "layers" and c["containers"] == ["symjax"])
    named = {name.strip() for layer in layers for name in layer.replace("|", ":").split(":")}
    packages = {path.parent.name for path in ROOT.glob("*/__init__.py")}
    assert packages | {"errors"} == named


@pytest.mark.skipif(importlib.util.find_spec("importlinter") is None, reason="import-linter is in the extra dev")
def test_the_contracts_of_import_linter_hold():
    done = subprocess.run(["lint-imports", "--no-cache"], capture_output=True, text=True, cwd=PROJECT, check=False)
    assert done.returncode == 0, done.stdout


def test_the_package_imports_neither_experiments_nor_notebooks_nor_tests():
    for path in ROOT.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for other in ("experiments", "notebooks", "tests"):
            assert f"import {other}" not in text
            assert f"from {other}" not in text
