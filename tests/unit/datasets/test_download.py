"""Downloads from a server on this machine: checked, kept, and what can go wrong on the way."""

import logging
import subprocess
import sys

import numpy as np
import pytest

from symjax import datasets
from symjax.datasets import download
from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.io.cache_folder import VARIABLE
from tests.helpers.model_server import PRISM

pytest.importorskip("pooch")
pytestmark = pytest.mark.usefixtures("cache")


def kept(cache):
    """All files below the cache folder."""
    return [path for path in cache.rglob("*") if path.is_file()]


def test_the_second_time_no_server_is_needed(tent, site):
    first = datasets.load("tent")
    site.close()
    np.testing.assert_array_equal(datasets.load("tent").points, first.points)
    assert site.asked == ["/tent-low-res.obj"]


def test_a_damaged_copy_is_replaced(tent, site):
    path = datasets.load("tent").path
    path.write_bytes(PRISM[:-40])
    assert datasets.load("tent").path.read_bytes() == PRISM
    assert len(site.asked) == 2


def test_a_file_put_there_by_hand_will_do(tent, site, cache):
    (cache / "models").mkdir(parents=True)
    (cache / "models" / "tent.obj").write_bytes(PRISM)
    datasets.load("tent")
    assert not site.asked


def test_another_file_than_was_published_is_refused(tent, site, cache):
    site.put("/tent-low-res.obj", PRISM.replace(b"-1.0", b"-1.1"))
    with pytest.raises(FileFormatError, match=r"cannot fetch 'tent': SHA256 .* does not match .*tent\.obj yourself"):
        datasets.load("tent")
    assert not kept(cache)


def test_a_truncated_body_is_refused(tent, site, cache):
    site.put("/tent-low-res.obj", PRISM[:200], length=len(PRISM))
    with pytest.raises(FileFormatError, match="cannot fetch 'tent'"):
        datasets.load("tent")
    assert not kept(cache)


@pytest.mark.parametrize(("status", "reason"), [(404, "404 Client Error"), (503, "503 Server Error")])
def test_what_the_server_says_is_said(tent, site, cache, status, reason):
    site.put("/tent-low-res.obj", b"sorry", status=status)
    with pytest.raises(FileFormatError, match=f"cannot fetch 'tent': {reason}.*; try again, or save http://") as caught:
        datasets.load("tent")
    assert not kept(cache)
    assert caught.value.__cause__.response.raw.closed


def test_no_network(tent, site, cache):
    site.close()
    with pytest.raises(FileFormatError, match=r"cannot fetch 'tent': .*127\.0\.0\.1") as caught:
        datasets.load("tent")
    assert "\n" not in str(caught.value)
    assert not kept(cache)


def test_a_silent_server_is_given_up(tent, site, cache, monkeypatch):
    site.put("/tent-low-res.obj", PRISM[:200], length=len(PRISM))
    site.gate.clear()
    monkeypatch.setattr(download, "TIMEOUT", 0.2)
    with pytest.raises(FileFormatError, match=r"cannot fetch 'tent': .*timed out"):
        datasets.load("tent")
    assert not kept(cache)


def test_a_cache_that_cannot_be_written(tent, tmp_path, monkeypatch):
    (tmp_path / "file").write_bytes(b"")
    monkeypatch.setenv(VARIABLE, str(tmp_path / "file" / "below"))
    with pytest.raises(FileFormatError, match=r"cannot fetch 'tent': .*file"):
        datasets.load("tent")


def test_plain_http_is_refused_before_anything_is_asked(tent, site, monkeypatch):
    monkeypatch.setattr(download, "SCHEME", "https://")
    with pytest.raises(InvalidArgumentError, match=r"http://.* is not fetched: the address must begin with https://"):
        datasets.load("tent")
    assert not site.asked


def test_without_pooch_it_says_what_to_install(tent, monkeypatch):
    monkeypatch.setitem(sys.modules, "pooch", None)
    with pytest.raises(InvalidArgumentError, match=r'pip install "pooch>=1\.8"'):
        datasets.load("tent")


def test_a_download_is_silent_and_leaves_the_logger_alone(tent, capfd):
    level = logging.getLogger("pooch").level
    datasets.load("tent")
    assert capfd.readouterr() == ("", "")
    assert logging.getLogger("pooch").level == level


def test_pooch_is_imported_when_it_is_needed():
    code = "import sys, symjax.datasets; sys.exit('pooch' in sys.modules or 'requests' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
