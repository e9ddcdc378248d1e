"""Importing symjax has no side effects, and every public name exists and is documented."""

import subprocess
import sys
from types import ModuleType

import pytest

import symjax

MODULES = ("datasets", "metrics")


def run(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


def test_importing_everything_changes_no_flags_seeds_or_environment_variables():
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


def test_every_public_name_exists_and_is_documented():
    for _ in range(2):
        for name in symjax.__all__:
            found = getattr(symjax, name)
            assert found.__doc__
            assert isinstance(found, ModuleType) == (name in MODULES)
    # a module would shadow a function of the same name
    assert callable(symjax.detect)
    assert callable(symjax.load)
    with pytest.raises(AttributeError, match="nothing"):
        symjax.nothing  # noqa: B018


def test_the_public_metrics_exist():
    assert {"deviation_angle", "offset_error"} <= set(dir(symjax.metrics))
