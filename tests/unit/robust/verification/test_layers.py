"""Sampling layers enter the standard errors, and a plane that they leave uncertain is not found."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symjax
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.preprocess.layers import Layers
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.layers import with_layers
from tests.helpers.layers import sliced, voxels

MIRROR = Plane(np.array([1.0, 0.0, 0.0]), 0.0)
NONE = Uncertainty(np.zeros((3, 3)), np.eye(3)[1:], np.zeros(3))


@pytest.fixture(scope="module")
def surface():
    return estimate_surface(symjax.datasets.generate("quadruped", num_points=2_000, rng=1).points / 2)


def layered(surface, direction, gap):
    normal = np.asarray(direction) / np.linalg.norm(direction)
    layers = Layers(gap, 0.2 * gap, normal, are_planes=True)
    return with_layers(NONE, MIRROR, surface, np.ones(len(surface.points)), layers)


def test_the_error_of_layers_grows_with_the_gap(surface):
    narrow, wide = (layered(surface, [1, 1, 0], gap).normal_degrees for gap in (0.02, 0.08))
    assert wide > 3 * narrow
    assert 0.01 < narrow < 1


def test_layers_across_the_mirror_plane_leave_its_normal_certain(surface):
    """Each of them is symmetric about the plane, wherever it lies."""
    across, along = (layered(surface, direction, 0.05) for direction in ([0, 0, 1], [1, 0, 0]))
    assert across.normal_degrees < 0.3 * along.normal_degrees
    assert across.offset < 0.3 * along.offset


def test_the_plane_of_a_sliced_object_is_found_within_its_standard_errors():
    det = symjax.detect(sliced("quadruped", 1 / 35, [0.3, 0.5, 0.8]))
    angle = np.degrees(np.arccos(abs(det.plane.normal[0])))
    assert det.found
    assert det.symmetry == "one plane"
    assert angle < min(2, 3 * det.uncertainty.normal_degrees)
    assert det.uncertainty.normal_degrees < 3


def test_the_plane_of_very_coarse_slices_is_not_found():
    det = symjax.detect(sliced("quadruped", 1 / 8, [0.3, 0.5, 0.8]))
    assert not det.found
    assert det.planes == ()
    assert det.symmetry == "none"
    assert any("not certain enough to be a mirror plane" in note for note in det.notes)


def test_without_layers_their_error_is_left_out():
    points = sliced("quadruped", 1 / 35, [0.3, 0.5, 0.8])
    with_error, without = (symjax.detect(points, symjax.Robust(use_layers=use)) for use in (True, False))
    assert with_error.uncertainty.normal_degrees > without.uncertainty.normal_degrees
    assert np.array_equal(with_error.plane.normal, without.plane.normal)


def test_the_step_of_thick_voxels_does_not_turn_the_plane():
    """With the voxels of the steps, the plane turned towards one that maps the layers onto themselves."""
    turn = Rotation.from_euler("zy", [12, 8], degrees=True)
    det = symjax.detect(voxels("quadruped", (1 / 150, 1 / 150, 1 / 30), turn=turn.as_matrix()))
    assert det.found
    assert np.degrees(np.arccos(abs(det.plane.normal[0]))) < 2
