"""Gross contradiction: a handle refutes the planes that move it, a cut refutes none."""

from functools import cache

import numpy as np
import pytest

from symjax.geometry.plane import Plane
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.contradiction import Completion, contradiction, far_distance
from symjax.robust.verification.scoring import score_plane
from symjax.robust.voxel_grid import voxel_grid
from tests.helpers.vessels import handle, vessel

ALONG_HANDLE, ACROSS_HANDLE = (Plane(np.eye(3)[axis], np.float64(0.0)) for axis in (1, 0))


@cache
def surface_and_grid(part):
    rng = np.random.default_rng(5)
    points = vessel(6000, rng)
    if part == "cut":
        points = points[np.linalg.norm(points - [1.0, 0.0, 0.0], axis=1) > 0.8]
    if part == "handle":
        points = np.concatenate([points, handle(700, rng)])
    found = estimate_surface(points / np.linalg.norm(np.ptp(points, axis=0)))
    return found, voxel_grid(found, None, boundary_penalty=0.15)


def contradiction_of(plane, part, **options):
    surface, grid = surface_and_grid(part)
    return contradiction(plane, surface, score_plane(plane, surface, grid), one_sided=False, **options)


@pytest.mark.parametrize("plane", [ALONG_HANDLE, ACROSS_HANDLE])
def test_a_whole_body_of_revolution_contradicts_no_plane_through_its_axis(plane):
    assert contradiction_of(plane, "whole") == (0.0, 0.0, 1.0)


def test_a_handle_refutes_the_planes_that_move_it_and_only_those():
    surface, _ = surface_and_grid("handle")
    limit = far_distance(surface) * np.linalg.norm(np.ptp(surface.points, axis=0))
    assert limit < 0.4  # the handle stands out farther
    assert contradiction_of(ALONG_HANDLE, "handle").gross == 0
    against = contradiction_of(ACROSS_HANDLE, "handle")
    assert 0.05 < against.gross < 700 / 6700
    assert against.refuting == against.gross
    assert against.at_boundary < 0.1


def test_a_cut_contradicts_the_planes_that_move_it_but_explains_itself():
    assert contradiction_of(ALONG_HANDLE, "cut").gross == 0
    against = contradiction_of(ACROSS_HANDLE, "cut")
    assert against.gross > 0.02
    assert against.refuting == 0
    assert against.at_boundary > 0.8
    assert contradiction_of(ACROSS_HANDLE, "cut", excused=1.1).refuting == against.gross


def test_the_completed_cloud_excuses_less():
    surface, _ = surface_and_grid("cut")
    cut = Completion(surface, surface.points, surface.confidence)
    across_axis = Plane(np.array([0.0, 0.0, 1.0]), np.float64(0.0))
    tilted = Plane(np.array([0.6, 0.0, 0.8]), np.float64(0.0))
    assert cut.contradiction(ACROSS_HANDLE) > 0.02
    assert cut.add(ACROSS_HANDLE).contradiction(across_axis) == 0
    assert cut.add(ACROSS_HANDLE).contradiction(tilted) > 0.05
    # this plane maps the cut onto itself, and fills nothing
    assert cut.add(ALONG_HANDLE).contradiction(ACROSS_HANDLE) > 0.02
    assert len(cut.add(ALONG_HANDLE).add(ACROSS_HANDLE).points) == 4 * len(surface.points)
