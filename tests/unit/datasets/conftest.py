"""Fixtures of the tests of downloaded models."""

import pytest

from symjax.datasets import MODELS, download
from symjax.io.cache_folder import VARIABLE
from tests.helpers.model_server import PRISM, Site, original


@pytest.fixture
def site(monkeypatch):
    """A local server for one test, reached without a proxy."""
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.setattr(download, "SCHEME", "http://")
    site = Site()
    yield site
    site.close()


@pytest.fixture
def cache(monkeypatch, tmp_path):
    """An empty cache folder."""
    monkeypatch.setenv(VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def tent(monkeypatch, site):
    """An entry of the registry whose mesh is on the local server."""
    entry = original(site.put("/tent-low-res.obj", PRISM), PRISM)
    monkeypatch.setitem(MODELS, "tent", entry)
    return entry
