"""Flat clouds: the outline of a sheet, and the planes that are upright on it."""

import numpy as np
import pytest

import symjax
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.robust.sheet import find_sheet, uncertainty_in_space, upright


def egg(rng, count, *, filled):
    """Returns points of an outline in the plane z = 0 that is symmetric about y = 0 only."""
    turn = rng.uniform(0, 2 * np.pi, count)
    radius = 1 + 0.3 * np.cos(turn) + 0.2 * np.cos(3 * turn) + 0.15 * np.cos(5 * turn)
    radius *= np.sqrt(rng.uniform(size=count)) if filled else 1
    return np.c_[radius * np.cos(turn), radius * np.sin(turn), np.zeros(count)]


def posed(points, rng, scale=40.0):
    """Returns turned and scaled points, and the directions of y and z there."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return scale * points @ turn.T + [100.0, -50.0, 3.0], turn[:, 1], turn[:, 2]


def rectangle(rng, count):
    return np.c_[rng.uniform(-1, 1, size=(count, 2)) * [1.0, 0.6], np.zeros(count)]


def z_shape(rng, count):
    """Returns points of a filled letter Z, which has no mirror line."""
    xy = rng.uniform(-1, 1, size=(4 * count, 2))
    bars = np.abs(xy[:, 1] - np.sign(xy[:, 1])) < 0.4
    stem = np.abs(xy[:, 0]) < 0.3
    kept = np.where(bars, xy[:, 0] * np.sign(xy[:, 1]) < 0.3, stem)
    return np.c_[xy[kept][:count], np.zeros(min(count, kept.sum()))]


@pytest.mark.parametrize("filled", [False, True])
@pytest.mark.parametrize("noise", [0.0, 0.005])
def test_the_plane_of_an_outline_is_found(rng, filled, noise):
    points = egg(rng, 1_500, filled=filled)
    points += noise * rng.normal(size=points.shape)
    points, normal, own = posed(points, rng)
    found = symjax.detect(points)
    assert found.symmetry == "one plane"
    angle = found.plane.angle(Plane(normal, 0.0))
    assert angle < (0.7 if filled else 0.2)
    assert angle < 4 * found.uncertainty.normal_degrees + 0.001
    for candidate in found.candidates:
        assert abs(candidate.plane.normal @ own) < 0.05
    assert any("coplanar" in note for note in found.notes)
    assert found.inlier_fraction > 0.9


def test_a_rectangle_has_two_planes_and_a_disc_an_axis(rng):
    points, _, own = posed(rectangle(rng, 1_000), rng)
    found = symjax.detect(points)
    assert (found.symmetry, len(found.planes)) == ("several planes", 2)
    points = rectangle(rng, 2_000) / [1.0, 0.6, 1.0]
    points, _, own = posed(points[np.linalg.norm(points, axis=1) < 1], rng)
    found = symjax.detect(points)
    assert found.symmetry == "axis"
    assert abs(found.axis[1] @ own) > 0.9999


def test_an_outline_without_a_mirror_line_has_no_plane(rng):
    points, _, _ = posed(z_shape(rng, 1_500), rng)
    assert symjax.detect(points).symmetry == "none"


def test_points_scattered_over_the_sheet_are_removed(rng):
    strewn = np.c_[rng.uniform(-1.7, 1.7, size=(400, 2)), np.zeros(400)]
    points, normal, _ = posed(np.vstack([egg(rng, 1_000, filled=False), strewn]), rng)
    found = symjax.detect(points)
    assert found.cleaned
    assert found.symmetry == "one plane"
    assert found.plane.angle(Plane(normal, 0.0)) < 0.2


def test_an_initial_plane_may_be_that_of_the_sheet(rng):
    points, normal, own = posed(egg(rng, 600, filled=False), rng)
    found = symjax.detect(points, symjax.Robust(init=Plane(own, own @ points[0])))
    assert found.plane.angle(Plane(normal, 0.0)) < 0.2


def test_the_asymmetry_of_a_flat_cloud_is_measured_in_its_sheet(rng):
    points = rectangle(rng, 2_000)
    bump = np.c_[rng.uniform(0.8, 1.0, size=(100, 1)), rng.uniform(0.6, 0.9, size=(100, 1)), np.zeros((100, 1))]
    found = symjax.detect(points)
    plane = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))
    found = type(found)(**{**vars(found), "plane": plane, "points": np.vstack([points, bump])})
    found = type(found)(**{**vars(found), "used": np.arange(2_100)})
    asymmetry = found.asymmetry()
    assert np.quantile(np.abs(asymmetry[:2_000]), 0.99) < 0.02
    assert 0.05 < np.median(asymmetry[2_000:]) < 0.2


def test_the_normals_of_an_outline_lie_in_the_sheet_and_point_outwards(rng):
    turn = rng.uniform(0, 2 * np.pi, 3_000)
    for filled in (True, False):
        radius = 0.35 * (np.sqrt(rng.uniform(size=3_000)) if filled else np.ones(3_000))
        sheet = find_sheet(np.c_[radius * np.cos(turn), radius * np.sin(turn), 0.001 * rng.normal(size=3_000)])
        assert sheet.filled is filled
        at = sheet.outline.points
        np.testing.assert_allclose(np.linalg.norm(at, axis=1), 0.35, atol=0.02)
        cosine = np.abs((at * sheet.outline.normals).sum(axis=1)) / np.linalg.norm(at, axis=1)
        assert np.median(cosine) > 0.98
        assert not sheet.outline.normals[:, 2].any()
        assert not at[:, 2].any()


def test_a_turned_plane_becomes_upright():
    plane = upright(Plane(np.array([0.6, 0.0, 0.8]), np.float64(0.3)))
    np.testing.assert_allclose(plane.normal, [1.0, 0.0, 0.0])
    # it meets the sheet z = 0 in the same line
    np.testing.assert_allclose(plane.offset, 0.5)


def test_the_tilt_of_a_noisy_sheet_is_in_the_standard_error(rng):
    plane = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))
    uncertainty = Uncertainty(np.zeros((3, 3)), np.array([[0.0, 0.6, 0.8], [0.0, -0.8, 0.6]]), np.zeros(3))
    slopes = []
    points = np.c_[rng.uniform(-1, 1, size=(400, 2)), np.zeros(400)]
    sheet = find_sheet(points + [0, 0, 0.1] * rng.normal(size=(400, 3)))
    for _ in range(200):
        slopes.append(np.polyfit(points[:, 0], 0.1 * rng.normal(size=400), 1)[0])
    degrees = uncertainty_in_space(uncertainty, plane, sheet).normal_degrees
    np.testing.assert_allclose(degrees, np.degrees(np.std(slopes)), rtol=0.15)
