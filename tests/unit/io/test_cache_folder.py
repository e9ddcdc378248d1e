"""An environment variable sets the folder for downloads and compiled programs; the default is in the cache folder."""

from pathlib import Path

from symjax.io.cache_folder import VARIABLE, cache_folder


def test_the_folder_is_that_of_the_variable_or_in_the_users_cache(monkeypatch):
    monkeypatch.setenv(VARIABLE, "~/models")
    assert cache_folder() == Path.home() / "models"
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.setenv("XDG_CACHE_HOME", "/caches")
    assert cache_folder() == Path("/caches/symjax")
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert cache_folder() == Path.home() / ".cache" / "symjax"
