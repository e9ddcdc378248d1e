"""The PNG image: its size, reproducible bytes, the colours in each panel, and degenerate clouds."""

import numpy as np
import pytest
from PIL import Image

from symjax.errors import InvalidArgumentError, TooFewPointsError
from symjax.viz import colours
from symjax.viz.png import draw, write_png
from symjax.viz.rasteriser import shaded_discs
from tests.helpers.detections import blob, detection_of

SMALL = (600, 300)


def share_of(pixels, colour):
    """Returns the fraction of the pixels whose hue is near that of `colour`."""
    shade = pixels - pixels.mean(axis=-1, keepdims=True)
    target = np.array(colour) - np.mean(colour)
    strength = np.linalg.norm(shade, axis=-1)
    return np.mean((strength > 30) & (shade @ target > 0.9 * strength * np.linalg.norm(target)))


def test_the_image_has_the_given_size(tmp_path, rng):
    detection = detection_of(blob(rng), weights=(1.0, 0.5, 0.0))
    write_png(detection, tmp_path / "default.png")
    write_png(detection, tmp_path / "small.png", size=(641, 333))
    for name, size in {"default.png": (1500, 750), "small.png": (641, 333)}.items():
        with Image.open(tmp_path / name) as image:
            assert (image.format, image.mode, image.size) == ("PNG", "RGB", size)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["default.png", "small.png"]


def test_the_same_detection_gives_the_same_bytes(tmp_path, rng):
    points = blob(rng)
    for name in ("a.png", "b.png"):
        write_png(detection_of(points, weights=(1.0, 0.5, 0.0)), tmp_path / name, size=SMALL)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_every_part_is_visible_in_its_panel(rng):
    # with only one half of the cloud, its mirror image covers another place
    points = blob(rng, 3000)
    points = points[points @ (0.6, 0.0, 0.8) > 0.3]
    pixels = np.asarray(draw(detection_of(points, weights=(1.0,) * 60)), dtype=float)[96:690]
    left, right = pixels[:, :750], pixels[:, 750:]
    for panel, expected in (
        (left, {colours.CLOUD: True, colours.PLANE: True, colours.PAIR: True, colours.MIRRORED: False}),
        (right, {colours.CLOUD: True, colours.PLANE: True, colours.PAIR: False, colours.MIRRORED: True}),
    ):
        for colour, seen in expected.items():
            share = share_of(panel, colour)
            assert share > 0.003 if seen else share < 0.0005, (colour, share)


def test_rejected_pairs_are_faint(rng):
    points = blob(rng)
    red, grey, none = (
        np.asarray(draw(detection_of(points, weights=weights), size=SMALL), dtype=float)[60:260, :300]
        for weights in ((1.0,) * 40, (0.0,) * 40, ())
    )
    assert share_of(red, colours.PAIR) > 10 * share_of(grey, colours.PAIR)
    assert 0 < np.abs(grey - none).mean() < np.abs(red - none).mean()


def test_moving_the_object_does_not_change_the_image(rng):
    points = blob(rng)
    normal, shift = np.array([0.6, 0.0, 0.8]), np.array([1e8, -3e8, 2e8])
    near = draw(detection_of(points), size=SMALL)
    far = draw(detection_of(points + shift, offset=0.3 + normal @ shift), size=SMALL)
    panel = (0, 40, 600, 276)  # below the headline, which states another offset
    difference = np.abs(np.subtract(near.crop(panel), far.crop(panel), dtype=float))
    assert difference.mean() < 0.5


@pytest.mark.parametrize(
    "points",
    [
        np.zeros((5, 3)),
        np.outer(np.linspace(-1, 1, 9), (0.6, 0.0, 0.8)),
        np.outer(np.linspace(-1, 1, 9), (0.0, 1.0, 0.0)),
        np.random.default_rng(1).normal(size=(50, 3)) * (1, 1, 0),
        np.random.default_rng(1).normal(size=(5, 3)) * 1e-12,
        np.random.default_rng(1).normal(size=(50, 3)) * 1e12,
        np.concatenate([np.random.default_rng(1).normal(size=(500, 3)), [[1e9, 0, 0]]]),
    ],
    ids=["one place", "line along normal", "line in plane", "coplanar", "tiny", "huge", "one outlier"],
)
def test_degenerate_clouds_are_drawn(points):
    normal = np.array([0.6, 0.0, 0.8])
    offset = normal @ np.median(points, axis=0)
    image = np.asarray(draw(detection_of(points, normal=normal, offset=offset), size=SMALL), dtype=float)
    assert share_of(image[40:270, :300], colours.PLANE) > 0.005
    assert share_of(image[40:270, :300], colours.CLOUD) > 1e-4


def test_a_coplanar_cloud_is_drawn_in_its_own_plane(rng):
    points = rng.normal(size=(300, 3)) * (1, 1, 0)
    image = np.asarray(draw(detection_of(points, normal=(0.0, 0.0, 1.0), offset=0.0), size=SMALL), dtype=float)
    assert share_of(image[40:270, :300], colours.CLOUD) > 0.005


def test_only_the_headline_says_whether_a_plane_was_found(rng):
    points = blob(rng)
    found, lost = (draw(detection_of(points, found=found), size=SMALL) for found in (True, False))
    headline, below = (0, 0, 600, 20), (0, 40, 600, 300)
    assert found.crop(headline) != lost.crop(headline)
    assert found.crop(below) == lost.crop(below)


def test_up_points_up(rng):
    # an arrow within the plane x = 0: thick above, thin below
    height = rng.uniform(-1, 1, 4000)
    points = np.stack([*(rng.normal(size=(2, 4000)) * np.where(height > 0.5, 0.3, 0.03)), height], axis=1)
    for sign in (1, -1):
        image = draw(detection_of(points, normal=(1.0, 0.0, 0.0), offset=0.0), size=SMALL, up=(0, 0, sign))
        blue = np.asarray(image, dtype=float)[40:270, :300] - np.array(colours.CLOUD)
        rows = np.sum(np.linalg.norm(blue, axis=-1) < 60, axis=1)
        upper, lower = np.split(rows, 2)
        assert (upper.sum() > lower.sum()) == (sign > 0)


def test_the_nearest_disc_is_visible():
    centres = np.array([[5.0, 5.0, 1.0], [5.0, 5.0, 3.0], [5.0, 5.0, 2.0], [40.0, 40.0, 9.0]])
    colours = np.array([[250, 0, 0], [0, 250, 0], [0, 0, 250], [9, 9, 9]])
    picture, covered = shaded_discs(centres, colours, 2, size=100.0, depths=(0.0, 3.0), height=12, width=10)
    red, green, blue = picture[5, 5]
    assert green > 200
    assert max(red, blue) < 20
    rows, columns = np.nonzero(covered)
    assert (np.hypot(rows - 5, columns - 5) <= 2.3).all()
    assert len(rows) == 21


def test_a_surface_behind_an_edge_is_darker():
    grid = np.stack(np.meshgrid(np.arange(60.0), np.arange(60.0)), axis=-1).reshape(-1, 2)
    step = np.where(grid[:, 0] < 30, 20.0, 0.0)  # a near wall on the left
    colours = np.full((len(grid), 3), 128)
    picture, _ = shaded_discs(
        np.column_stack([grid, step]), colours, 1, size=100.0, depths=(-1.0, -1.0), height=60, width=60
    )
    row = picture[30, :, 0].astype(int)
    assert row[31] < row[50] - 10
    assert abs(row[15] - row[50]) <= 20


def test_bad_arguments_are_refused(tmp_path, rng):
    detection = detection_of(blob(rng))
    with pytest.raises(InvalidArgumentError, match="size must be at least"):
        write_png(detection, tmp_path / "a.png", size=(100, 100))
    with pytest.raises(InvalidArgumentError, match="cannot write"):
        write_png(detection, tmp_path / "missing" / "a.png", size=SMALL)
    with pytest.raises(TooFewPointsError):
        write_png(detection_of(blob(rng), points=None), tmp_path / "a.png")
    assert not list(tmp_path.iterdir())
