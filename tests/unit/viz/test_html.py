"""The interactive page: one file that loads nothing, escapes all text, and shows the detection."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from symjax.errors import InvalidArgumentError, TooFewPointsError
from symjax.viz import html
from symjax.viz.drawable import Drawable
from symjax.viz.html import figure, write_html
from tests.helpers.detections import blob, detection_of

HOSTILE = "</script></title><script>alert(1)</script><img src=x onerror=alert(1)>&\"'"


class Page(HTMLParser):
    """The start tags of a page with their attributes, and the text inside each kind of element."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.text, self._open = [], {}, []
        self.feed(path.read_text(encoding="utf-8"))
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag != "meta":
            self._open.append(tag)

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        if self._open:
            self.text[self._open[-1]] = self.text.get(self._open[-1], "") + data


def coordinates(trace):
    return np.stack([np.asarray(trace[name], dtype=float) for name in "xyz"], axis=1)


def named(fig, start):
    return [trace for trace in fig.data if trace.name.startswith(start)]


def test_the_page_is_one_file_that_loads_nothing(tmp_path, rng):
    path = tmp_path / "page.html"
    write_html(detection_of(blob(rng), weights=(1.0, 0.5, 0.0)), path, title="cup")
    assert [file.name for file in tmp_path.iterdir()] == ["page.html"]
    page = Page(path)
    for tag, attributes in page.tags:
        assert tag not in {"link", "iframe", "object", "embed", "base", "img"}
        assert not {"src", "href", "srcset", "action"} & attributes.keys(), (tag, attributes)
    policy = next(a["content"] for _, a in page.tags if a.get("http-equiv") == "Content-Security-Policy")
    assert "default-src 'none'" in policy
    assert "http" not in policy
    assert page.text["title"] == "cup"


def test_the_page_is_reproducible_and_has_one_figure(tmp_path, rng):
    points = blob(rng)
    pages = []
    for name in ("a.html", "b.html"):
        write_html(detection_of(points), tmp_path / name)
        pages.append((tmp_path / name).read_bytes())
    assert pages[0] == pages[1]
    ids = [attributes["id"] for _, attributes in Page(tmp_path / "a.html").tags if "id" in attributes]
    assert ids == ["symjax-figure"]


def test_title_and_notes_are_escaped(tmp_path, rng):
    points = blob(rng)
    write_html(detection_of(points), tmp_path / "tame.html")
    hostile = detection_of(points, method=HOSTILE, notes=(HOSTILE, "{plot_id} {0}"))
    write_html(hostile, tmp_path / "hostile.html", title=HOSTILE)
    tame, wild = Page(tmp_path / "tame.html"), Page(tmp_path / "hostile.html")
    assert wild.tags == tame.tags
    assert wild.text["title"] == HOSTILE
    assert wild.text["footer"] == f"Method: {HOSTILE} · {HOSTILE} · {{plot_id}} {{0}}"


def test_a_failure_leaves_an_existing_page_unchanged(tmp_path, rng):
    path = tmp_path / "page.html"
    path.write_text("old")
    with pytest.raises(InvalidArgumentError, match="max_points"):
        write_html(detection_of(blob(rng)), path, max_points=0)
    assert path.read_text() == "old"
    with pytest.raises(InvalidArgumentError, match="missing"):
        write_html(detection_of(blob(rng)), tmp_path / "missing" / "page.html")
    assert [file.name for file in tmp_path.iterdir()] == ["page.html"]


def test_the_figure_shows_the_cloud_and_its_mirror_image(rng):
    points = blob(rng)
    detection = detection_of(points)
    fig = figure(detection)
    for trace in named(fig, "cloud"):
        np.testing.assert_allclose(np.sort(coordinates(trace), axis=0), np.sort(points, axis=0), atol=1e-6)
    (mirrored,) = named(fig, "mirror image")
    expected = np.sort(detection.mirror(points), axis=0)
    np.testing.assert_allclose(np.sort(coordinates(mirrored), axis=0), expected, atol=1e-6)
    for scene in (fig.layout.scene, fig.layout.scene2):
        shown = np.array([scene[f"{name}axis"].range for name in "xyz"])
        for cloud in (points, detection.mirror(points)):
            assert (shown[:, 0] <= cloud.min(axis=0)).all()
            assert (shown[:, 1] >= cloud.max(axis=0)).all()
        ratio = np.array([scene.aspectratio[name] for name in "xyz"]) / np.ptp(shown, axis=1)
        np.testing.assert_allclose(ratio, ratio[0])


@pytest.mark.parametrize("up", [None, (0.0, 0.0, 1.0), (0.6, 0.0, 0.8)])
def test_the_quad_lies_in_the_plane_and_spans_the_cloud(rng, up):
    points = blob(rng)
    detection = detection_of(points, candidates=3)
    normal, offset = detection.plane
    fig = figure(detection, up=up)
    face, edge = named(fig, "mirror plane")
    corners = coordinates(face)
    np.testing.assert_allclose(corners @ normal, offset, atol=1e-9)
    np.testing.assert_array_equal(coordinates(edge), corners[[0, 1, 2, 3, 0]])
    first, second = corners[1] - corners[0], corners[3] - corners[0]
    assert abs(first @ second) < 1e-9
    for side in (first, second):
        share = (points - corners[0]) @ side / (side @ side)
        assert share.min() >= 0
        assert share.max() <= 1
    for rank, candidate in enumerate(detection.candidates[1:], start=2):
        other, _ = named(fig, f"candidate {rank}")
        assert other.visible == "legendonly"
        np.testing.assert_allclose(coordinates(other) @ candidate.plane.normal, candidate.plane.offset, atol=1e-9)


def test_pairs_are_matched_or_rejected_by_their_weight(rng):
    points = blob(rng)
    detection = detection_of(points, weights=(1.0, 0.4, 0.001, 0.9, 0.0), inlier_weight=0.4)
    fig = figure(detection)
    (matched,), (rejected,) = named(fig, "matched pairs"), named(fig, "rejected pairs")
    assert matched.name == "matched pairs (3)"
    assert rejected.name == "rejected pairs (2)"
    assert rejected.opacity < matched.opacity == 1
    segments = coordinates(matched).reshape(3, 3, 3)
    np.testing.assert_allclose(segments[:, 0], points[[0, 1, 3]], atol=1e-12)
    np.testing.assert_allclose(segments[:, 1], detection.mirror(points[[0, 1, 3]]), atol=1e-12)
    assert np.isnan(segments[:, 2]).all()


def drawn_and_written(fig, start):
    """Returns the number of drawn pairs, and the number of pairs in the legend."""
    (trace,) = named(fig, start)
    return len(coordinates(trace)) // 3, int(re.search(r"\((\d+)", trace.name)[1])


@pytest.mark.parametrize("inlier_weight", [0.02, 0.5, 0.9])
def test_the_inliers_are_drawn_as_matched_pairs(rng, inlier_weight):
    weights = rng.random(300)
    detection = detection_of(blob(rng), weights=weights, inlier_weight=inlier_weight)
    num_inliers = int(np.sum(weights >= inlier_weight))
    fig = figure(detection)
    assert drawn_and_written(fig, "matched pairs") == (num_inliers, num_inliers)
    assert drawn_and_written(fig, "rejected pairs") == (300 - num_inliers, 300 - num_inliers)


def test_the_legend_counts_pairs_that_are_not_drawn(rng, monkeypatch):
    monkeypatch.setattr(html, "MAX_PAIRS", 100)
    weights = rng.random(300)
    fig = figure(detection_of(blob(rng), weights=weights))
    drawn, written = drawn_and_written(fig, "matched pairs")
    assert written == np.sum(weights >= 0.5)
    assert drawn + drawn_and_written(fig, "rejected pairs")[0] == 100
    assert f"({written}, {drawn} drawn)" in named(fig, "matched pairs")[0].name


def test_any_object_that_implements_the_protocol_is_drawn(rng):
    detection = detection_of(blob(rng), weights=(1.0, 0.0))
    names = [name for name in vars(Drawable) if not name.startswith("_")]
    other = SimpleNamespace(**{name: getattr(detection, name) for name in names})
    assert figure(other) == figure(detection)


def test_removed_points_are_a_trace_of_their_own(rng):
    points = np.concatenate([blob(rng), [[50.0, 0.0, 0.0], [0.0, 50.0, 0.0]]])
    fig = figure(detection_of(points, cleaned=True, used=np.arange(400)))
    (removed,) = named(fig, "removed points")
    shown = {tuple(row) for row in coordinates(removed).tolist()}
    assert {(50.0, 0.0, 0.0), (0.0, 50.0, 0.0)} <= shown
    assert len(coordinates(fig.data[0])) + len(shown) == len(points)


def test_a_detection_without_pairs_or_without_a_mirror_plane_is_drawn(rng):
    fig = figure(detection_of(blob(rng), found=False, score=0.1))
    assert {trace.name for trace in fig.data} == {"cloud", "mirror image", "mirror plane"}
    assert "No mirror plane found" in fig.layout.title.text
    assert "not above the threshold" in fig.layout.title.text


def test_the_headline_states_the_plane_and_the_evidence(rng):
    text = figure(detection_of(blob(rng), weights=(1.0,) * 8)).layout.title.text
    assert "(0.6000, 0.0000, 0.8000) · x = 0.3" in text
    assert "Score 0.600, above the threshold of 0.300; 75% of 8 pairs are inliers" in text


def test_a_method_without_threshold_or_pairs_is_drawn(rng):
    fig = figure(detection_of(blob(rng), threshold=None, inlier_fraction=None))
    assert "Score 0.600<" in fig.layout.title.text


def test_thinning_is_reproducible(rng):
    detection = detection_of(blob(rng, 5000))
    first, second = (coordinates(figure(detection, max_points=1000).data[0]) for _ in range(2))
    assert len(first) == 1000
    np.testing.assert_array_equal(first, second)


def test_a_distant_cloud_keeps_its_precision(rng):
    points = blob(rng)
    normal, far = np.array([0.6, 0.0, 0.8]), np.array([3e8, -1e8, 0.0])
    fig = figure(detection_of(points + far, normal=normal, offset=0.3 + normal @ far))
    shown = coordinates(fig.data[0])
    assert np.abs(shown).max() < 10
    np.testing.assert_allclose(np.ptp(shown, axis=0), np.ptp(points, axis=0), atol=1e-5)
    np.testing.assert_allclose(
        coordinates(named(fig, "mirror plane")[0]) @ normal,
        0.3 - normal @ ((points.max(axis=0) + points.min(axis=0)) / 2),
        atol=1e-5,
    )
    assert fig.layout.scene.xaxis.title.text.startswith("x − 30000000")
    assert fig.layout.scene.yaxis.title.text.startswith("y + 10000000")


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((5, 3)),
        np.outer(np.linspace(-1, 1, 9), (0.6, 0.0, 0.8)),
        np.random.default_rng(1).normal(size=(50, 3)) * (1, 1, 0),
        np.eye(3),
    ],
    ids=["one place", "line along the normal", "coplanar", "three points"],
)
def test_degenerate_clouds_are_drawn(points):
    fig = figure(detection_of(points))
    corners = coordinates(named(fig, "mirror plane")[0])
    assert np.linalg.norm(np.cross(corners[1] - corners[0], corners[3] - corners[0])) > 1e-3


def test_points_that_are_not_finite_are_not_drawn(rng):
    points = blob(rng)
    points[7, 1], points[11] = np.nan, np.inf
    assert len(coordinates(figure(detection_of(points)).data[0])) == len(points) - 2


def test_a_detection_without_points_is_refused(rng):
    with pytest.raises(TooFewPointsError, match="loaded without its points"):
        figure(detection_of(blob(rng), points=None))
    with pytest.raises(TooFewPointsError, match="no finite point"):
        figure(detection_of(np.full((3, 3), np.nan)))


def test_up_must_be_a_direction(rng):
    for up in [(0, 0, 0), (0, np.nan, 1), (0, 1)]:
        with pytest.raises(InvalidArgumentError, match="up must be three finite numbers"):
            figure(detection_of(blob(rng)), up=up)


def test_drawing_imports_neither_jax_nor_plotly():
    code = "import sys, symjax.viz.html, symjax.viz.png; print({'jax', 'plotly'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_viz_does_not_import_the_detection():
    for path in Path(html.__file__).parent.glob("*.py"):
        assert "symjax.detection" not in path.read_text(encoding="utf-8")
