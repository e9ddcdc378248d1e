"""Strict numerics for every test: float64, rank promotion raises; warnings are errors (pyproject.toml)."""

from pathlib import Path

import jax
import numpy as np
import pytest

SHARED = Path(__file__).resolve().parents[2] / "shared"


def pytest_addoption(parser):
    parser.addoption("--default-flags", action="store_true", help="leave JAX's flags alone (use with -m core)")


def pytest_configure(config):
    jax.config.update("jax_numpy_rank_promotion", "raise")
    if not config.getoption("--default-flags"):
        jax.config.update("jax_enable_x64", True)


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
