"""Importing symjax is cheap, leaves everything as it was, and every public name is there and documented."""

import subprocess
import sys
from types import ModuleType

import pytest

import symjax

MODULES = ("datasets", "metrics")


def run(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


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
            assert isinstance(found, ModuleType) == (name in MODULES)
    # a function that shares its name with a module would be replaced by it
    assert callable(symjax.detect)
    assert callable(symjax.load)
    with pytest.raises(AttributeError, match="nothing"):
        symjax.nothing  # noqa: B018


def test_the_metrics_keep_their_names():
    assert {"deviation_angle", "offset_error"} <= set(dir(symjax.metrics))
