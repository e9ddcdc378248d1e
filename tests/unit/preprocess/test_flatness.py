"""Flat clouds are told from reliefs, shells and plates with two faces."""

import numpy as np
import pytest

from symjax.datasets import generate
from symjax.preprocess.cloud_frame import to_cloud_frame
from symjax.preprocess.flatness import is_flat

NUM_POINTS = 1_000


def flat(heights, rng):
    """Returns whether a rectangle whose heights are a function of the position in it is flat."""
    xy = rng.uniform(-1, 1, size=(NUM_POINTS, 2)) * [1.0, 0.6]
    return is_flat(to_cloud_frame(np.c_[xy, heights(*xy.T)]).points)


@pytest.mark.parametrize("noise", [0.0, 1e-7, 1e-4, 0.01, 0.04])
def test_a_sheet_with_noise_across_it_is_flat(rng, noise):
    assert flat(lambda x, y: noise * rng.normal(size=len(x)), rng)
    assert flat(lambda x, y: noise * rng.uniform(-1, 1, size=len(x)), rng)


@pytest.mark.parametrize("height", [1e-4, 0.01, 0.05])
def test_a_relief_and_a_shell_are_not_flat(rng, height):
    assert not flat(lambda x, y: height * np.sin(3 * x) * np.cos(4 * y), rng)
    assert not flat(lambda x, y: height * (x**2 + y**2), rng)
    assert not flat(lambda x, y: height * (np.sin(3 * x) * np.cos(4 * y) + rng.normal(size=len(x)) / 2), rng)


@pytest.mark.parametrize("thickness", [1e-4, 0.01, 0.05])
@pytest.mark.parametrize("share", [0.5, 0.2])
def test_a_plate_with_two_faces_is_not_flat(rng, thickness, share):
    assert not flat(lambda x, y: thickness * (rng.uniform(size=len(x)) < share), rng)
    # faces three standard deviations of the noise from their middle
    assert not flat(lambda x, y: thickness * ((rng.uniform(size=len(x)) < 0.5) + rng.normal(size=len(x)) / 6), rng)


@pytest.mark.parametrize("kind", ["quadruped", "car", "chair", "ball"])
@pytest.mark.parametrize("squashed", [0.01, 0.1, 1.0])
def test_an_object_is_not_flat_however_thin_it_is(kind, squashed):
    points = to_cloud_frame(generate(kind, num_points=NUM_POINTS, rng=0).points).points
    assert not is_flat(to_cloud_frame(points * [1.0, 1.0, squashed]).points)


def test_a_plate_with_a_knob_is_not_flat(rng):
    assert not flat(lambda x, y: 0.1 * (x**2 + y**2 < 0.03) + 0.001 * rng.normal(size=len(x)), rng)
