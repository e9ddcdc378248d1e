"""A scale sweep: its fits, computed in batches, its optima, and its page."""

import numpy as np
import pytest

from symjax import datasets, detect, sweep
from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import DegenerateCloudError, NonfiniteError, TooFewPointsError
from symjax.geometry.directions import deviation_angle, fibonacci
from symjax.geometry.plane import Plane
from symjax.scale_sweep import run
from symjax.scale_sweep.optima import NOT_CONVERGED, optima, ranks
from symjax.scale_sweep.page import figure, write_html
from symjax.scale_sweep.pairs import cloud_pairs, given_pairs
from symjax.scale_sweep.run import Options, scale_sweep
from symjax.scale_sweep.sphere_map import COLOURS, NAMES, colour_index

NOISE = 0.01
FRACTIONS = (0.01, 0.03, 0.1)
OPTIONS = Options("fibonacci", 8, "newton", False, 0)
TRUTH = planted_pairs(np.random.default_rng(7), 240, 0.3, "wide", noise=NOISE)


def swept(options=OPTIONS, events=None):
    pairs = given_pairs(TRUTH.x, TRUTH.y)
    events = [] if events is None else events
    return scale_sweep(
        pairs, FRACTIONS, options, stage=events.append, advance=lambda done, total: events.append((done, total))
    )


EVENTS = []


@pytest.fixture(scope="module")
def found():
    """A scale sweep with one σ per batch."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "SLOTS", 8)
        return swept(events=EVENTS)


def test_the_planted_plane_is_found_and_sigma_estimated(found):
    assert np.asarray(found.best.converged).all()
    for plane in (found.best.plane, found.estimated.plane):
        assert (deviation_angle(plane.normal, TRUTH.normal) < 3).all()
    np.testing.assert_allclose(found.estimated.sigma, NOISE, rtol=0.15)
    np.testing.assert_allclose(found.estimated.inlier_fraction, 0.7, atol=0.06)


@pytest.mark.slow
def test_batches_give_the_same_fits_as_one_sweep(found):
    fits = sweep(TRUTH.x, TRUTH.y, np.array(FRACTIONS) * found.pairs.diagonal, "fibonacci", restarts=8)
    np.testing.assert_array_equal(found.fits.converged, fits.converged)
    np.testing.assert_allclose(found.fits.loss, fits.loss, rtol=1e-9)
    np.testing.assert_allclose(found.fits.plane.normal, fits.plane.normal, atol=1e-7)
    np.testing.assert_allclose(found.fits.sigma, fits.sigma, rtol=1e-14)


def test_progress_is_reported(found):
    assert EVENTS == ["sweeping sigma", (0, 3), (1, 3), (2, 3), (3, 3), "estimating sigma"]


def test_starts_are_evenly_spread(found):
    even = fibonacci(8)
    for normals in found.fits.start.normal:
        assert (deviation_angle(normals, even) < 1e-6).all()
    # each starts at an offset within the cloud
    low, high = (f(found.fits.start.normal @ TRUTH.x.T, axis=2) for f in (np.min, np.max))
    assert ((found.fits.start.offset > low) & (found.fits.start.offset < high)).all()


@pytest.mark.slow
def test_a_continuation_has_optima_and_no_starts():
    followed = swept(OPTIONS._replace(start="l2", restarts=256, continuation=True))
    assert followed.rank.shape == (3, followed.options.restarts) == (3, 1)
    assert followed.fits.start is None
    assert (deviation_angle(followed.best.plane.normal, TRUTH.normal) < 3).all()
    cells, starts, marks = figure(followed).frames[0].data
    assert len(set(cells.intensity)) == 1
    assert len(starts.x) == 0
    assert len(marks.x) == 2


def random_fits(rng, number=40, distinct=6):
    """Planes with few distinct values and random signs, their losses, and which distinct plane each is."""
    normals = rng.normal(size=(distinct, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    which = np.concatenate([np.arange(distinct), rng.integers(distinct, size=number - distinct)])
    sign = rng.choice([-1.0, 1.0], size=number)
    offsets, losses = rng.normal(size=distinct), np.sort(rng.normal(size=distinct))
    return Plane(sign[:, None] * normals[which], sign * offsets[which]), losses[which], which


def test_ranks_do_not_depend_on_signs_or_order(rng):
    planes, loss, which = random_fits(rng)
    place = {"centre": np.zeros(3), "diagonal": 1.0}
    np.testing.assert_array_equal(ranks(planes, loss, np.ones(40, bool), **place), which)
    order = rng.permutation(40)
    shuffled = ranks(Plane(*(part[order] for part in planes)), loss[order], np.ones(40, bool), **place)
    np.testing.assert_array_equal(shuffled, which[order])
    far = Plane(planes.normal, planes.offset + planes.normal @ np.full(3, 1e3))
    moved = ranks(far, loss, np.ones(40, bool), centre=np.full(3, 1e3), diagonal=1.0)
    np.testing.assert_array_equal(moved, which)


def test_fits_that_did_not_converge_have_no_rank(rng):
    planes, loss, which = random_fits(rng)
    loss[1] = np.nan
    rank = ranks(planes, loss, which != 0, centre=np.zeros(3), diagonal=1.0)
    assert (rank[which == 0] == NOT_CONVERGED).all()
    assert rank[1] == NOT_CONVERGED
    listed = optima(planes, loss, rank)
    assert len(listed) == rank.max() + 1
    assert [optimum.loss for optimum in listed] == sorted(optimum.loss for optimum in listed)
    assert np.isclose(sum(optimum.fraction for optimum in listed), np.mean(rank != NOT_CONVERGED))
    assert (ranks(planes, loss, np.zeros(40, bool), centre=np.zeros(3), diagonal=1.0) == NOT_CONVERGED).all()
    assert optima(planes, loss, np.full(40, NOT_CONVERGED)) == []


def test_the_centre_and_diagonal_of_pairs_are_equivariant(rng):
    x, y = rng.normal(size=(2, 50, 3)) * (3, 2, 1)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    one, other = given_pairs(x, y), given_pairs(7 * x @ frame + 100, 7 * y @ frame + 100)
    np.testing.assert_allclose(other.diagonal, 7 * one.diagonal)
    np.testing.assert_allclose(other.centre, 7 * one.centre @ frame + 100)
    box = np.array([[i, j, k] for i in (0, 3) for j in (0, 2) for k in (0, 1)], float)
    np.testing.assert_allclose(given_pairs(box, box).diagonal, np.sqrt(14))


def test_bad_pairs_are_refused(rng):
    x, y = rng.normal(size=(2, 10, 3))
    y[4, 1] = np.nan
    with pytest.raises(NonfiniteError, match="index 4"):
        given_pairs(x, y)
    kept = given_pairs(x, y, nonfinite="drop")
    np.testing.assert_array_equal(kept.x, np.delete(x, 4, axis=0))
    assert "1 of 10" in kept.notes[1]
    with pytest.raises(TooFewPointsError, match="2 pairs are too few"):
        given_pairs(x[:2], x[:2])
    with pytest.raises(DegenerateCloudError, match="coincide"):
        given_pairs(np.ones((5, 3)), np.ones((5, 3)))


def test_pairs_of_a_cloud_are_those_of_sym_hks_and_agree_with_its_plane():
    rng = np.random.default_rng(3)
    cloud = datasets.pose(datasets.generate("quadruped", num_points=1500, rng=rng), rng)
    pairs = cloud_pairs(cloud.points)
    detected = detect(cloud.points, "sym-hks").pairs
    np.testing.assert_array_equal(pairs.x, detected.x)
    np.testing.assert_array_equal(pairs.y, detected.y)
    rows = {tuple(row) for row in cloud.points}
    assert all(tuple(end) in rows for end in (*pairs.x, *pairs.y))
    truth = Plane(cloud.normals[0], cloud.offsets[0])
    apart = np.linalg.norm(np.asarray(truth.reflect(pairs.x)) - pairs.y, axis=1)
    assert np.median(apart) < 0.05 * pairs.diagonal


def test_the_page_shows_basins_and_optima(found):
    fig = figure(found)
    assert len(fig.frames) == len(fig.layout.sliders[0].steps) == len(FRACTIONS)
    names = {trace.name for trace in fig.data}
    assert {NAMES[index] for index in np.unique(colour_index(found.rank))} <= names
    for index, frame in enumerate(fig.frames):
        cells, starts, marks = frame.data
        reached = colour_index(found.rank[index])
        np.testing.assert_array_equal(starts.marker.color, np.tile(reached, 2))
        drawn = np.stack([starts.x, starts.y, starts.z], axis=1)
        drawn /= np.linalg.norm(drawn, axis=1, keepdims=True)
        np.testing.assert_allclose(drawn[:8], found.fits.start.normal[index], atol=1e-6)
        np.testing.assert_allclose(drawn[8:], -drawn[:8], atol=1e-6)
        assert set(cells.intensity) <= {*reached.tolist(), len(COLOURS)}
        normals = np.stack([marks.x, marks.y, marks.z], axis=1)
        best = found.best.plane.normal[index]
        assert deviation_angle(normals[0], best) < 1e-6
        assert len(normals) == 2 * (found.rank[index].max() + 1)


def test_panels_show_the_best_plane_at_every_sigma(found):
    fig = figure(found)
    angles, distances, losses = (trace for trace in fig.data if trace.type == "scatter" and trace.mode == "lines")
    for line in (angles, distances, losses):
        np.testing.assert_array_equal(line.x, FRACTIONS)
    expected = deviation_angle(found.best.plane.normal, found.estimated.plane.normal)
    np.testing.assert_allclose(angles.y, np.maximum(expected, 1e-3))
    # in units of the integral of the squared Gaussian the loss is 1 - 2 rho, where rho may exceed 1
    unit = (4 * np.pi * np.asarray(found.best.sigma) ** 2) ** 1.5
    np.testing.assert_allclose(losses.y, unit * found.best.loss, rtol=1e-9)
    np.testing.assert_array_equal(found.best.inlier_fraction, np.minimum((1 - losses.y) / 2, 1))


def test_the_page_is_one_file_that_loads_nothing(found, tmp_path):
    hostile = found._replace(pairs=found.pairs._replace(notes=("<script>alert(1)</script>",)))
    write_html(hostile, tmp_path / "page.html", title="a < b")
    assert [file.name for file in tmp_path.iterdir()] == ["page.html"]
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert "<title>a &lt; b</title>" in text
    assert "<script>alert(1)" not in text
    assert "default-src 'none'" in text
