"""Clouds that are sampled on layers: slices, scan lines and surface voxels of generated objects."""

from functools import cache

import numpy as np
from scipy.ndimage import binary_erosion

from symjax.datasets import build, generate

SLAB = 0.04
"""Thickness of the slabs whose points are moved onto the layers, in gaps."""


@cache
def dense(kind, seed=1, num_points=40_000):
    return generate(kind, num_points=num_points, rng=seed).points


def diagonal(kind):
    return np.linalg.norm(np.ptp(dense(kind), axis=0))


def sliced(kind, gap, direction, *, bend=0.0, jitter=0.0, noise=0.0, seed=0):
    """Points of an object on layers along a direction; lengths are in diagonals of the object, but jitter in gaps."""
    rng = np.random.default_rng(seed)
    points, unit = dense(kind), np.asarray(direction) / np.linalg.norm(direction)
    gap = gap * diagonal(kind)
    side = np.roll(unit, 1) - unit * (np.roll(unit, 1) @ unit)
    height = points @ unit + bend * diagonal(kind) * np.sin(4 * points @ side) + 0.37 * gap
    layer = np.round(height / gap).astype(int)
    shift = rng.uniform(-jitter, jitter, layer.max() - layer.min() + 1)[layer - layer.min()]
    above = height - (layer + shift) * gap
    on_layer = np.abs(above) < 0.5 * SLAB * gap
    moved = points[on_layer] - above[on_layer, None] * unit
    return moved + rng.normal(scale=noise * gap, size=moved.shape)


def voxels(kind, spacing, *, turn=None):
    """Centres of the surface voxels of an object, whose sides are in diagonals of the object."""
    solid, points = build(kind, np.random.default_rng(1)), dense(kind)
    turn = np.eye(3) if turn is None else turn
    side = np.asarray(spacing) * diagonal(kind)
    low, high = (points @ turn.T).min(axis=0) - 2 * side, (points @ turn.T).max(axis=0) + 2 * side
    ticks = [np.arange(a + 0.3 * s, b, s) for a, b, s in zip(low, high, side, strict=True)]
    centres = np.stack(np.meshgrid(*ticks, indexing="ij"), axis=-1)
    flat = (centres.reshape(-1, 3) @ turn).T
    inside = (solid.field(flat) < 0).reshape(centres.shape[:3])
    return flat.T.reshape(centres.shape)[inside & ~binary_erosion(inside)]
