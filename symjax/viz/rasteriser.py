"""A rasteriser of point clouds: shaded discs with a depth buffer, in NumPy only.

The shading is eye-dome lighting: a pixel is darkened if its neighbours are nearer to the viewer (Boucheny, "Interactive
scientific visualisation of large datasets: towards a perceptive-based approach", 2009). It shows the shape without
normals.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

SHADOW = 0.9
"""Exponent of the darkest shadow, whose light is exp(-0.9)."""

SHADOW_DEPTH = 0.04
"""Difference in depth that gives half of the darkest shadow, as a fraction of the scene's size."""

EDGE_DARKENING = 0.15
"""Loss of light at the edge of a disc, so that overlapping discs can be distinguished."""

HAZE = 0.35
"""Fraction of white in the colour of the farthest points."""


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
    """Draws points as shaded discs.

    Args:
        centres: pixel column, pixel row, and nearness to the viewer in pixels.
        colours: red, green and blue of each point, 0 to 255.
        radius: radius of the discs, in pixels.
        size: size of the scene, in pixels.
        depths: nearness to the viewer at which the haze is full, and at which there is none.
        height: number of rows of the image.
        width: number of columns of the image.

    Returns:
        The image, and a mask of the pixels that a disc covers.
    """
    order = np.argsort(centres[:, 2], kind="stable")
    centres, colours = centres[order], colours[order]
    nearest, edge = _splat(centres[:, :2], radius, height, width)
    covered = nearest >= 0
    near = np.full(nearest.shape, -np.inf)
    near[covered] = here = centres[nearest[covered], 2]
    light = _eye_dome_lighting(near, covered, radius, SHADOW_DEPTH * size) * (1 - EDGE_DARKENING * edge[covered])
    far_end, near_end = depths
    haze = HAZE * np.clip((near_end - here) / max(near_end - far_end, 1e-9 * size), 0, 1)
    lit = colours[nearest[covered]] * light[:, None]
    picture = np.full((*nearest.shape, 3), 255, np.uint8)
    picture[covered] = lit + (255 - lit) * haze[:, None]
    return picture, covered


def _splat(
    centres: Float[np.ndarray, "n 2"], radius: int, height: int, width: int
) -> tuple[Int[np.ndarray, "height width"], Float[np.ndarray, "height width"]]:
    """Finds the nearest disc at each pixel (−1 for none), and (d / radius)² at distance d from the centre of that disc.

    `centres` must be sorted, farthest first. If several discs cover a pixel, NumPy keeps the last write, the nearest.
    """
    index = np.flatnonzero(((centres >= 0) & (centres < (width, height))).all(axis=1))
    columns, rows = centres[index].astype(np.int64).T
    stride = width + 2 * radius  # a border as wide as a radius, so that no disc is clipped
    centre_pixel = (rows + radius) * stride + columns + radius
    nearest = np.full(stride * (height + 2 * radius), -1, np.int64)
    edge = np.zeros(len(nearest), np.float32)
    for dy, dx in _disc(radius):
        pixel = centre_pixel + dy * stride + dx
        is_nearer = index > nearest[pixel]
        nearest[pixel[is_nearer]] = index[is_nearer]
        edge[pixel[is_nearer]] = (dx * dx + dy * dy) / (radius * radius)
    crop = (slice(radius, radius + height), slice(radius, radius + width))
    return nearest.reshape(-1, stride)[crop], edge.reshape(-1, stride)[crop]


def _disc(radius: int) -> list[tuple[int, int]]:
    """Returns the offsets (row, column) of the pixels of a disc."""
    span = range(-radius, radius + 1)
    return [(dy, dx) for dy in span for dx in span if dx * dx + dy * dy <= radius * (radius + 0.5)]


def _eye_dome_lighting(
    near: Float[np.ndarray, "height width"], covered: Bool[np.ndarray, "height width"], step: int, half: float
) -> Float[np.ndarray, " p"]:
    """Computes the light on the covered pixels, in (0, 1].

    A pixel is darkened by pixels `step` and 3 `step` away that are nearer to the viewer. A difference of `half` in
    depth gives half of the full shadow. `near` is −inf at pixels that are not covered.
    """
    border = 3 * step
    padded = np.pad(near, border, constant_values=-np.inf)
    rows, columns = np.nonzero(covered)
    centre_pixel = (rows + border) * padded.shape[1] + columns + border
    here = near[covered]
    shade = np.zeros_like(here)
    for reach in (step, 3 * step):
        for dy, dx in ((-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (-1, 1), (1, -1), (1, 1)):
            neighbour = padded.ravel()[centre_pixel + reach * (dy * padded.shape[1] + dx)]
            rise = np.maximum(neighbour - here, 0)
            shade += rise / (rise + half)
    light: Float[np.ndarray, " p"] = np.exp(-SHADOW * shade / 8)
    return light
