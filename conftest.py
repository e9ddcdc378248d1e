"""Strict numerics for every test and doctest: float64, rank promotion raises; warnings are errors (pyproject.toml)."""

import gc
from pathlib import Path

import jax
import numpy as np
import pytest

from tests.helpers import shape_checks

MOST_MAPS = 30_000
"""Memory maps at which compiled programs are dropped: each has some ten, Linux allows 65 530, and the compiler crashes
where it gets no more."""

ROOT = Path(__file__).resolve().parent
TESTS = ROOT / "tests"
SHARED = ROOT.parent / "shared"

# here and not in `pytest_configure`: a conftest of a folder named on the command line imports symjax before that
shape_checks.install()

CORE = ("architecture", "cli/test_detect.py", "cli/test_main.py", "helpers")
CORE_PACKAGES = ("datasets", "detection", "geometry", "io", "preprocess", "viz")
"""Tests and packages that compile little or nothing: with those marked `any_precision` they are the core."""


def pytest_addoption(parser):
    parser.addoption("--default-flags", action="store_true", help="leave JAX's flags alone (with -m any_precision)")


def pytest_configure(config):
    jax.config.update("jax_numpy_rank_promotion", "raise")
    jax.config.update("jax_numpy_dtype_promotion", "strict")
    if not config.getoption("--default-flags"):
        jax.config.update("jax_enable_x64", True)


def pytest_collection_modifyitems(items):
    folders = [*(TESTS / name for name in CORE), *(TESTS / "unit" / name for name in CORE_PACKAGES)]
    for item in items:
        quick = item.get_closest_marker("any_precision") or any(item.path.is_relative_to(folder) for folder in folders)
        if quick and not any(item.get_closest_marker(name) for name in ("slow", "network")):
            item.add_marker(pytest.mark.core)
        if "models" in item.fixturenames:
            item.add_marker(pytest.mark.models)


@pytest.fixture(scope="module", autouse=True)
def _few_memory_maps():
    yield
    maps = Path("/proc/self/maps")
    if maps.is_file() and maps.read_bytes().count(b"\n") > MOST_MAPS:
        jax.clear_caches()
        gc.collect()


@pytest.fixture
def rng():
    return np.random.default_rng(20261123)


@pytest.fixture(scope="session")
def models():
    """The folder of real models beside the project; absent on a clean checkout, and then the test is skipped."""
    folder = SHARED / "data" / "models"
    if not folder.is_dir():
        pytest.skip(f"real models not found at {folder}: tests on them are skipped")
    return folder
