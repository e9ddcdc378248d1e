"""Real models: downloaded from a server on this machine, checked, kept; and what can go wrong on the way."""

import hashlib
import json
import logging
import re
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest

from symjax import datasets
from symjax.datasets import MODELS, Original, download
from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.io.points import CLOUDS, MESHES, read_points

pytest.importorskip("pooch")

# a prism of quads and triangles, written as the originals are: textures, normals, groups, materials
PRISM = b"""# a tent, mirror x = 0.5
mtllib tent.mtl
o tent
v 0.500000 1.000000 0.000000
v -1.000000 0.000000 0.000000
v 2.000000 0.000000 0.000000
v 0.500000 1.000000 4.000000
v -1.000000 0.000000 4.000000
v 2.000000 0.000000 4.000000
vt 0.0 0.0
vt 1.0 0.5
vn 0.0 0.0 1.0
g ends
usemtl cloth
s off
f 3/1/1 2/2/1 1/1/1
f 4/1/1 5/2/1 6/1/1
g sides
f 1/1/1 2/2/1 5/1/1 4/2/1
f 3/1/1 1/2/1 4/1/1 6/2/1
f 2/1/1 3/2/1 6/1/1 5/2/1
"""
CORNERS = np.array([[0.5, 1, 0], [-1, 0, 0], [2, 0, 0], [0.5, 1, 4], [-1, 0, 4], [2, 0, 4]])
SCAN = b"""# .PCD v0.7 - Point Cloud Data file format
VERSION 0.7
FIELDS x y z intensity
SIZE 4 4 4 4
TYPE F F F F
COUNT 1 1 1 1
WIDTH 6
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS 6
DATA binary
""" + np.column_stack([CORNERS, np.ones(6)]).astype("<f4").tobytes()


class Site:
    """What a server has: status, body and promised length by path; the paths that were asked for; a gate to close."""

    def __init__(self):
        self.pages, self.asked, self.gate = {}, [], threading.Event()
        self.gate.set()
        site = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                site.asked.append(self.path)
                status, body, length = site.pages.get(self.path, (404, b"", 0))
                self.send_response(status)
                self.send_header("Content-Length", str(length))
                self.end_headers()
                self.wfile.write(body)
                site.gate.wait()

            def log_message(self, *_):
                """Says nothing."""

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.thread = threading.Thread(target=self.server.serve_forever, kwargs={"poll_interval": 0.01})
        self.thread.start()

    def put(self, path, body, *, status=200, length=None):
        self.pages[path] = (status, body, len(body) if length is None else length)
        return f"http://127.0.0.1:{self.server.server_port}{path}"

    def close(self):
        self.gate.set()
        if self.thread.is_alive():
            self.server.shutdown()
            self.thread.join()
            self.server.server_close()


@pytest.fixture
def site(monkeypatch):
    """A server of this test's own; no proxy stands before it."""
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.setattr(download, "SCHEME", "http://")
    site = Site()
    yield site
    site.close()


@pytest.fixture(autouse=True)
def cache(monkeypatch, tmp_path):
    """An empty cache folder."""
    monkeypatch.setenv(download.CACHE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def original(url, body, normal=(1.0, 0.0, 0.0), offset=0.5, symmetry="exact"):
    digest = hashlib.sha256(body).hexdigest()
    return Original(url, digest, len(body), "CC BY 4.0", "a tentmaker", normal, offset, symmetry)


@pytest.fixture
def tent(monkeypatch, site):
    """A mesh in the registry that the server has."""
    entry = original(site.put("/tent-low-res.obj", PRISM), PRISM)
    monkeypatch.setitem(MODELS, "tent", entry)
    return entry


def kept(cache):
    """All files below the cache folder."""
    return [path for path in cache.rglob("*") if path.is_file()]


def test_a_mesh_comes_with_its_plane_and_whom_to_thank(tent, cache):
    model = datasets.load("tent", num_samples=500, rng=3)
    np.testing.assert_array_equal(model.surface.vertices, CORNERS)
    assert model.surface.num_faces == 5
    assert len(model.surface.triangles) == 8
    assert model.points.shape == (500, 3)
    assert (model.points.min(axis=0) >= CORNERS.min(axis=0)).all()
    assert (model.points.max(axis=0) <= CORNERS.max(axis=0)).all()
    images = model.plane.reflect(model.surface.vertices)
    assert {tuple(row) for row in images.tolist()} == {tuple(row) for row in CORNERS.tolist()}
    assert (model.symmetry, model.licence, model.attribution) == ("exact", "CC BY 4.0", "a tentmaker")
    assert kept(cache) == [model.path] == [cache / "models" / "tent.obj"]
    assert model.path.read_bytes() == PRISM


def test_its_points_are_those_of_its_file(tent):
    model = datasets.load("tent", num_samples=100, rng=5)
    np.testing.assert_array_equal(model.points, read_points(model.path, num_samples=100, rng=5).points)
    np.testing.assert_array_equal(model.points, datasets.load("tent", num_samples=100, rng=5).points)
    assert not np.array_equal(model.points, datasets.load("tent", num_samples=100, rng=6).points)


def test_a_scan_keeps_its_own_points_and_may_have_no_plane(site, monkeypatch):
    entry = original(site.put("/a/scan.pcd", SCAN), SCAN, None, None, "no known plane")
    monkeypatch.setitem(MODELS, "scan", entry)
    model = datasets.load("scan", num_samples=2)
    np.testing.assert_array_equal(model.points, CORNERS)
    assert model.surface.triangles.shape == (0, 3)
    assert model.plane is None
    assert model.symmetry == "no known plane"
    assert model.path.name == "scan.pcd"


def test_the_second_time_no_server_is_needed(tent, site):
    first = datasets.load("tent")
    site.close()
    np.testing.assert_array_equal(datasets.load("tent").points, first.points)
    assert site.asked == ["/tent-low-res.obj"]


def test_what_a_caller_does_to_a_model_stays_with_the_caller(tent):
    model = datasets.load("tent")
    model.plane.normal[:] = 7
    model.plane.offset[...] = 7
    again = datasets.load("tent")
    np.testing.assert_array_equal(again.plane.normal, [1, 0, 0])
    assert again.plane.offset == 0.5


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
    with pytest.raises(FileFormatError, match=f"cannot fetch 'tent': {reason}.*; try again, or save http://"):
        datasets.load("tent")
    assert not kept(cache)


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
    monkeypatch.setenv(download.CACHE, str(tmp_path / "file" / "below"))
    with pytest.raises(FileFormatError, match=r"cannot fetch 'tent': .*file"):
        datasets.load("tent")


def test_plain_http_is_refused_before_anything_is_asked(tent, site, monkeypatch):
    monkeypatch.setattr(download, "SCHEME", "https://")
    with pytest.raises(InvalidArgumentError, match=r"http://.* is not fetched: the address must begin with https://"):
        datasets.load("tent")
    assert not site.asked


def test_bad_requests_are_named(tent, site):
    with pytest.raises(InvalidArgumentError, match=r"no model 'unicorn': choose one of boat, boot, .*, spot, "):
        datasets.load("unicorn")
    with pytest.raises(InvalidArgumentError, match="num_samples must be at least 1, got 0"):
        datasets.load("tent", num_samples=0)
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


@pytest.mark.parametrize("name", MODELS)
def test_every_address_is_secure_pinned_and_of_a_format_that_is_read(name):
    entry = MODELS[name]
    assert re.fullmatch(r"https://raw\.githubusercontent\.com/[\w-]+/[\w-]+/[0-9a-f]{40}/[\w/.-]+", entry.url)
    assert re.fullmatch(r"[0-9a-f]{64}", entry.sha256)
    assert "." + entry.url.rsplit(".", 1)[1] in {*MESHES, *CLOUDS}
    assert entry.num_bytes > 0
    assert entry.licence
    assert entry.attribution
    assert entry.symmetry
    assert (entry.plane is None) == (entry.normal is None) == (entry.offset is None)
    if entry.plane is not None:
        assert np.linalg.norm(entry.plane.normal) == 1


def test_the_registry_is_the_one_beside_the_project(models):
    origins = json.loads((models.parent / "registry.json").read_text(encoding="utf-8"))
    planes = json.loads((models.parent / "planes.json").read_text(encoding="utf-8"))
    assert set(MODELS) == set(origins) == set(planes)
    for name, entry in MODELS.items():
        origin, plane = origins[name], planes[name]
        expected = (*(origin[key] for key in ("url", "sha256", "bytes", "licence", "attribution")), plane["kind"])
        assert (*entry[:5], entry.symmetry) == expected
        assert entry.offset == plane["offset"]
        assert entry.normal == (plane["normal"] and tuple(plane["normal"]))


def as_published(path):
    """A mesh beside the project, written as its publisher did: coordinates to six decimals."""
    surface = MESHES[path.suffix](path.read_bytes())
    rows = ["v {:.6f} {:.6f} {:.6f}\n".format(*vertex) for vertex in surface.vertices]
    return "".join(rows + ["f {} {} {}\n".format(*corners) for corners in surface.triangles + 1]).encode()


def test_originals_are_what_the_registry_says(models, site, monkeypatch):
    bodies = {name: (models / f"{name}.pcd").read_bytes() for name in ("car6", "cturtle", "milk")}
    bodies["cat"] = as_published(models / "cat.obj")
    for name, body in bodies.items():
        assert len(body) == MODELS[name].num_bytes
        address = site.put("/" + MODELS[name].url.rsplit("/", 1)[1], body)
        monkeypatch.setitem(MODELS, name, MODELS[name]._replace(url=address))
        model = datasets.load(name, num_samples=1000)
        beside = models / f"{name}{model.path.suffix}"
        np.testing.assert_array_equal(model.points, read_points(beside, num_samples=1000).points)
