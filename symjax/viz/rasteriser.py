"""Point clouds as shaded discs in a depth buffer, with NumPy alone.

A pixel is darkened where something nearer to the viewer stands beside it: eye-dome lighting (Boucheny, "Interactive
scientific visualisation of large datasets: towards a perceptive-based approach", 2009). It shows shape and asks
for no normals.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

SHADOW = 0.9
"""Exponent of the darkest shadow: light falls to exp(-0.9)."""

SHADOW_DEPTH = 0.04
"""Step in depth, as a share of the scene's size, that gives half of the darkest shadow."""

RIM = 0.15
"""Loss of light at a disc's rim: discs stay apart where they overlap."""

HAZE = 0.35
"""Share of white in the farthest points."""


def shaded_discs(
    centres: Float[np.ndarray, "n 3"],
    colours: Int[np.ndarray, "n 3"],
    radius: int,
    *,
    size: float,
    depths: tuple[float, float],
    height: int,
    width: int,
) -> tuple[UInt8[np.ndarray, "height width 3"], Bool[np.ndarray, "height width"]]:
    """Picture of the points, and where in it they are.

    Args:
        centres: pixel column, pixel row, and nearness to the viewer in pixels.
        colours: 0 to 255.
        radius: of the discs, in pixels.
        size: of the scene, in pixels.
        depths: nearness at which the haze is full, and at which there is none.
        height: rows of the picture.
        width: its columns.
    """
    ahead = np.argsort(centres[:, 2], kind="stable")
    centres, colours = centres[ahead], colours[ahead]
    winner, rim = _splat(centres[:, :2], radius, height, width)
    covered = winner >= 0
    near = np.full(winner.shape, -np.inf)
    near[covered] = here = centres[winner[covered], 2]
    light = _eye_dome_lighting(near, covered, radius, SHADOW_DEPTH * size) * (1 - RIM * rim[covered])
    far_end, near_end = depths
    haze = HAZE * np.clip((near_end - here) / max(near_end - far_end, 1e-9 * size), 0, 1)
    lit = colours[winner[covered]] * light[:, None]
    picture = np.full((*winner.shape, 3), 255, np.uint8)
    picture[covered] = lit + (255 - lit) * haze[:, None]
    return picture, covered


def _splat(
    centres: Float[np.ndarray, "n 2"], radius: int, height: int, width: int
) -> tuple[Int[np.ndarray, "height width"], Float[np.ndarray, "height width"]]:
    """The nearest disc at every pixel (−1: none) and how close to that disc's rim the pixel is (0 to 1).

    `centres` come farthest first: of several writes to one pixel NumPy keeps the last, which is the nearest.
    """
    index = np.flatnonzero(((centres >= 0) & (centres < (width, height))).all(axis=1))
    columns, rows = centres[index].astype(np.int64).T
    stride = width + 2 * radius  # a border as wide as a disc: no disc needs clipping
    home = (rows + radius) * stride + columns + radius
    winner = np.full(stride * (height + 2 * radius), -1, np.int64)
    rim = np.zeros(len(winner), np.float32)
    for dy, dx in _disc(radius):
        pixel = home + dy * stride + dx
        wins = index > winner[pixel]
        winner[pixel[wins]] = index[wins]
        rim[pixel[wins]] = (dx * dx + dy * dy) / (radius * radius)
    crop = (slice(radius, radius + height), slice(radius, radius + width))
    return winner.reshape(-1, stride)[crop], rim.reshape(-1, stride)[crop]


def _disc(radius: int) -> list[tuple[int, int]]:
    """Offsets of the pixels of a disc."""
    span = range(-radius, radius + 1)
    return [(dy, dx) for dy in span for dx in span if dx * dx + dy * dy <= radius * (radius + 0.5)]


def _eye_dome_lighting(
    near: Float[np.ndarray, "height width"], covered: Bool[np.ndarray, "height width"], step: int, half: float
) -> Float[np.ndarray, " p"]:
    """Light in (0, 1] of the covered pixels: less where pixels `step` or 3 `step` away are nearer.

    `near` is −inf where nothing is drawn; a difference of `half` in depth gives half of the full shadow.
    """
    border = 3 * step
    padded = np.pad(near, border, constant_values=-np.inf)
    rows, columns = np.nonzero(covered)
    home = (rows + border) * padded.shape[1] + columns + border
    here = near[covered]
    shade = np.zeros_like(here)
    for reach in (step, 3 * step):
        for dy, dx in ((-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (-1, 1), (1, -1), (1, 1)):
            neighbour = padded.ravel()[home + reach * (dy * padded.shape[1] + dx)]
            rise = np.maximum(neighbour - here, 0)
            shade += rise / (rise + half)
    return np.exp(-SHADOW * shade / 8)
