"""The PNG image of a detection: the cloud with its plane and pairs, and the completed object.

It is drawn with Pillow and NumPy only.
"""

import os
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from PIL import Image, ImageDraw, ImageFont

from symjax.errors import InvalidArgumentError
from symjax.io.atomic import replacing
from symjax.viz import colours
from symjax.viz import scene as scenes
from symjax.viz.drawable import Drawable
from symjax.viz.rasteriser import shaded_discs

MAX_POINTS = 300_000
MAX_PAIRS = 250
SMALLEST_SIZE = (400, 240)
SUPERSAMPLING = 2
"""Factor of supersampling in both directions, which smooths edges."""

BACKGROUND = (255, 255, 255)
PLANE_OPACITY = 0.28
COINCIDENT = 0.02
"""Distance by which the mirror image is moved away from the viewer, as a fraction of the scene's size. Where cloud and
mirror image coincide, the cloud is seen."""


class Panel(NamedTuple):
    """A view, scaled to a rectangle of supersampled pixels.

    Attributes:
        view: directions of the view.
        centre: point at the centre of the rectangle, along the right and up directions.
        scale: pixels per unit of length.
        width: width of the rectangle in pixels.
        height: height of the rectangle in pixels.
    """

    view: scenes.View
    centre: Float[np.ndarray, " 2"]
    scale: float
    width: int
    height: int

    def project(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Projects points to pixel column, pixel row, and nearness to the viewer in pixels."""
        column, row, near = (points @ np.stack(self.view).T).T
        return np.stack(
            [
                (column - self.centre[0]) * self.scale + self.width / 2,
                (self.centre[1] - row) * self.scale + self.height / 2,
                near * self.scale,
            ],
            axis=1,
        )

    def pixels(self, points: Float[np.ndarray, "n 3"]) -> list[tuple[float, float]]:
        """Projects points to pixel positions in the form that Pillow expects."""
        return [(float(column), float(row)) for column, row, _ in self.project(points)]


def write_png(
    detection: Drawable,
    path: str | os.PathLike[str],
    *,
    size: tuple[int, int] = (1500, 750),
    up: Sequence[float] | Float[np.ndarray, " 3"] | None = None,
) -> None:
    """Writes an image of a detection: the cloud, its plane and its pairs on the left, the completed cloud on the right.

    The same detection gives the same bytes. The plane is seen 27° from edge-on. Inlier pairs are red, and more opaque
    for a higher weight; rejected pairs are faint and grey.

    Args:
        detection: the detection to draw.
        path: file to write; an existing file is replaced.
        size: width and height in pixels.
        up: direction that points up; by default, the cloud's longest direction within the plane.

    Raises:
        TooFewPointsError: if the detection has no points.
        InvalidArgumentError: if `size` is too small, `up` is not a direction, or the file cannot be written.
    """
    image = draw(detection, size=size, up=up)
    with replacing(path) as temporary:
        image.save(temporary, format="PNG", optimize=True)


def draw(
    detection: Drawable,
    *,
    size: tuple[int, int] = (1500, 750),
    up: Sequence[float] | Float[np.ndarray, " 3"] | None = None,
) -> Image.Image:
    """Draws the image of `write_png` as a Pillow image, with the same arguments and errors."""
    if size[0] < SMALLEST_SIZE[0] or size[1] < SMALLEST_SIZE[1]:
        raise InvalidArgumentError(f"size must be at least {SMALLEST_SIZE} pixels, got {size}")
    scene = scenes.build(detection, max_points=MAX_POINTS, max_pairs=MAX_PAIRS, up=up)
    width, height = size
    unit = min(height, width / 2) / 750
    header, footer = round(96 * unit), round(52 * unit)
    panel = _fit(scene, width // 2, height - header - footer)

    page = Image.new("RGB", size, BACKGROUND)
    left = _draw_panel(panel, scene, scene.cloud, np.zeros(len(scene.cloud), bool), pairs=True)
    both = np.concatenate([scene.cloud, scene.mirrored])
    right = _draw_panel(panel, scene, both, np.arange(len(both)) >= len(scene.cloud), pairs=False)
    for column, drawn in ((0, left), (width // 2, right)):
        page.paste(drawn.reduce(SUPERSAMPLING), (column, header))
    _write_text(ImageDraw.Draw(page), scenes.headline(detection), scene, size, unit)
    return page


def _fit(scene: scenes.Scene, width: int, height: int) -> Panel:
    """Scales the view so that the completed cloud and the quad fill a panel of this size in pixels."""
    low, high = scenes.bounds(scene, np.stack(scene.view[:2]).T)
    width, height = width * SUPERSAMPLING, height * SUPERSAMPLING
    scale = 0.94 * float(np.min(np.array([width, height]) / np.maximum(high - low, 1e-3 * scene.size)))
    return Panel(scene.view, (low + high) / 2, scale, width, height)


def _draw_panel(
    panel: Panel,
    scene: scenes.Scene,
    points: Float[np.ndarray, "n 3"],
    is_mirrored: Bool[np.ndarray, " n"],
    *,
    pairs: bool,
) -> Image.Image:
    """Draws from back to front: the points behind the plane, the plane, and the points in front of it."""
    projected = panel.project(points)
    projected[is_mirrored, 2] -= COINCIDENT * scene.size * panel.scale
    paint = np.where(is_mirrored[:, None], colours.MIRRORED, colours.CLOUD)
    facing = 1.0 if scene.plane.normal @ scene.view.towards > 0 else -1.0
    side = facing * scene.plane.signed_distance(points)
    radius = _disc_radius(projected[~is_mirrored], panel)
    far, near = np.quantile(projected[:, 2], (0.01, 0.99)).tolist()
    canvas = Image.new("RGB", (panel.width, panel.height), BACKGROUND)
    if pairs:
        _draw_removed(canvas, panel, scene.removed)
    for is_front in (False, True):
        here = (side >= 0) == is_front
        if is_front:
            _draw_plane(canvas, panel, scene.quad)
        discs, covered = shaded_discs(
            projected[here],
            paint[here],
            radius,
            size=scene.size * panel.scale,
            depths=(far, near),
            height=panel.height,
            width=panel.width,
        )
        canvas.paste(Image.fromarray(discs), mask=Image.fromarray(covered))
        if pairs:
            _draw_pairs(canvas, panel, scene, facing if is_front else -facing)
    return canvas


def _draw_removed(canvas: Image.Image, panel: Panel, points: Float[np.ndarray, "s 3"]) -> None:
    """Draws the removed points as small faint dots, behind everything else."""
    brush = ImageDraw.Draw(canvas)
    for x, y in panel.pixels(points):
        brush.circle((x, y), SUPERSAMPLING, fill=colours.REMOVED)


def _disc_radius(projected: Float[np.ndarray, "n 3"], panel: Panel) -> int:
    """Chooses the radius at which the discs just cover the surface, if the cloud fills about half of its box."""
    low, high = scenes.robust_bounds(projected[:, :2])
    spacing = np.sqrt(np.prod(high - low) / len(projected))
    return int(np.clip(round(0.9 * spacing), SUPERSAMPLING, 0.009 * panel.height))


def _draw_plane(canvas: Image.Image, panel: Panel, quad: Float[np.ndarray, "4 3"]) -> None:
    """Draws the quad as a translucent face with an almost opaque edge."""
    brush = ImageDraw.Draw(canvas, "RGBA")
    corners = panel.pixels(quad)
    brush.polygon(corners, fill=(*colours.PLANE, round(255 * PLANE_OPACITY)))
    brush.line([*corners, corners[0]], fill=(*colours.PLANE, 235), width=2 * SUPERSAMPLING, joint="curve")


def _draw_pairs(canvas: Image.Image, panel: Panel, scene: scenes.Scene, sign: float) -> None:
    """Draws the parts of the pairs on one side of the plane, segments and ends, in the order of their weights."""
    brush = ImageDraw.Draw(canvas, "RGBA")
    ends = np.stack([scene.x, scene.y])
    heights = sign * np.stack([scene.plane.signed_distance(end) for end in ends])
    for i in np.argsort(scene.weight, kind="stable"):
        colour, opacity = _pair_paint(float(scene.weight[i]), bool(scene.is_inlier[i]))
        above = heights[:, i] >= 0
        if not above.any():
            continue
        segment = ends[:, i].copy()
        if not above.all():
            fraction = heights[0, i] / (heights[0, i] - heights[1, i])
            segment[int(above[0])] = ends[0, i] + fraction * (ends[1, i] - ends[0, i])
        brush.line(panel.pixels(segment), fill=(*colour, opacity), width=SUPERSAMPLING * (2 if opacity > 128 else 1))
        dot = 2.1 * SUPERSAMPLING
        for column, row in panel.pixels(ends[above, i]):
            brush.ellipse((column - dot, row - dot, column + dot, row + dot), fill=(*colour, min(255, opacity + 60)))


def _pair_paint(weight: float, is_inlier: bool) -> tuple[colours.Rgb, int]:
    """Returns the colour and the opacity (0 to 255) of a pair."""
    return (colours.PAIR, round(100 + 120 * weight)) if is_inlier else (colours.REJECTED, 70)


@lru_cache(maxsize=8)
def _font(pixels: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size=max(pixels, 8))


def _write_text(
    brush: ImageDraw.ImageDraw, headline: tuple[str, str], scene: scenes.Scene, size: tuple[int, int], unit: float
) -> None:
    """Writes the headline above both panels, and a legend below each."""
    width, height = size
    margin = round(28 * unit)
    equation, evidence = headline
    brush.text((margin, 20 * unit), equation, fill=colours.INK, font=_font(round(30 * unit)))
    brush.text((margin, 62 * unit), evidence, fill=colours.FAINT_INK, font=_font(round(20 * unit)))
    legends = (
        [(colours.CLOUD, "cloud"), (colours.PLANE, "mirror plane")]
        + ([(colours.PAIR, "matched pairs"), (colours.REJECTED, "rejected pairs")] if len(scene.weight) else [])
        + ([(colours.REMOVED, "removed points")] if len(scene.removed) else []),
        [(colours.CLOUD, "cloud"), (colours.MIRRORED, "mirror image")],
    )
    font = _font(round(18 * unit))
    middle, dot = height - 26 * unit, 6 * unit
    for start, legend in zip((margin, width // 2 + margin), legends, strict=True):
        column = float(start)
        for colour, label in legend:
            brush.rectangle((column, middle - dot, column + 2 * dot, middle + dot), fill=colour)
            column += 20 * unit
            brush.text((column, middle), label, fill=colours.FAINT_INK, font=font, anchor="lm")
            column += brush.textlength(label, font=font) + 26 * unit
