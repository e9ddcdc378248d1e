"""Real models, downloaded from a server on this machine: the points, the surface and the plane of each."""

import numpy as np
import pytest

from symjax import datasets
from symjax.datasets import MODELS
from symjax.errors import InvalidArgumentError
from symjax.io.points import MESHES, read_points
from tests.helpers.model_server import CORNERS, PRISM, SCAN, original

pytest.importorskip("pooch")
pytestmark = pytest.mark.usefixtures("cache")


def test_a_mesh_comes_with_its_plane_licence_and_attribution(tent, cache):
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
    assert model.path == cache / "models" / "tent.obj"
    assert model.path.read_bytes() == PRISM


def test_the_points_are_sampled_as_read_points_samples_them(tent):
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


def test_changing_a_model_does_not_change_the_registry(tent):
    model = datasets.load("tent")
    model.plane.normal[:] = 7
    model.plane.offset[...] = 7
    again = datasets.load("tent")
    np.testing.assert_array_equal(again.plane.normal, [1, 0, 0])
    assert again.plane.offset == 0.5


def test_bad_arguments_are_refused(tent, site):
    with pytest.raises(InvalidArgumentError, match=r"model 'unicorn' is unknown: choose one of boat, boot, .*, spot, "):
        datasets.load("unicorn")
    with pytest.raises(InvalidArgumentError, match="num_samples must be a whole number, at least 1, got 0"):
        datasets.load("tent", num_samples=0)
    assert not site.asked


def as_published(path):
    """Returns a mesh of the shared folder in the format of its publisher: coordinates to six decimals."""
    surface = MESHES[path.suffix](path.read_bytes())
    rows = ["v {:.6f} {:.6f} {:.6f}\n".format(*vertex) for vertex in surface.vertices]
    return "".join(rows + ["f {} {} {}\n".format(*corners) for corners in surface.triangles + 1]).encode()


def test_the_registry_describes_the_originals(models, site, monkeypatch):
    bodies = {name: (models / f"{name}.pcd").read_bytes() for name in ("car6", "cturtle", "milk")}
    bodies["cat"] = as_published(models / "cat.obj")
    for name, body in bodies.items():
        assert len(body) == MODELS[name].num_bytes
        address = site.put("/" + MODELS[name].url.rsplit("/", 1)[1], body)
        monkeypatch.setitem(MODELS, name, MODELS[name]._replace(url=address))
        model = datasets.load(name, num_samples=1000)
        beside = models / f"{name}{model.path.suffix}"
        np.testing.assert_array_equal(model.points, read_points(beside, num_samples=1000).points)


@pytest.mark.network
@pytest.mark.parametrize("name", list(MODELS))
def test_the_publisher_still_has_the_original(name):
    model = datasets.load(name)
    assert len(model.points)
    assert model.path.is_file()
