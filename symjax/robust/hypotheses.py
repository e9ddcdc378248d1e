"""Hypotheses: the planes that the search starts from, from three independent sources."""

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane
from symjax.robust.surface import Surface

NUM_DIRECTIONS, OFFSET_STEP = 400, 0.04
"""Number of evenly spread normals on half the sphere, 7° apart, and distance between the offsets of each, in
diagonals. The registration, whose σ starts at 0.05, bridges these steps."""

OUTER_FRACTION = 0.02
"""Fraction of the points that may lie beyond the outermost offsets. They must reach this far out: the mirror plane of
an object that was cut in half lies at the end of the cloud."""

NUM_UPRIGHT_DIRECTIONS = 90
"""Number of evenly spread normals within a flat cloud's sheet, 2° apart."""

NUM_PAIRED = 512
"""Number of random points of which all pairs are considered."""

MIN_COSINE = 0.95
"""Minimum cosine between the normal of one point of a pair and the reflected normal of the other. It corresponds to
18°, the error of a noisy normal."""

MIN_DISTANCE = 0.1
"""Minimum distance of the two points of a pair, in diagonals. The plane of a closer pair is too uncertain."""


def hypotheses(surface: Surface, rng: np.random.Generator, *, num_pairs: int, flat: bool = False) -> Plane:
    """Returns the hypotheses of all sources: principal axes, pairs of points, and evenly spread planes.

    Args:
        surface: the surface, in units of its diagonal.
        rng: random generator that draws the pairs.
        num_pairs: maximum number of hypotheses from pairs; 0 for none.
        flat: whether all points and normals lie in the sheet z = 0; then all planes are upright on it.

    Returns:
        A batch of 6 000 to 7 000 planes, or 2 500 if the cloud is flat.
    """
    principal = principal_planes(surface.points)
    sources = (
        Plane(principal.normal[1:], principal.offset[1:]) if flat else principal,
        pair_planes(surface, rng, num_pairs),
        even_planes(surface.points, _upright_directions() if flat else fibonacci(NUM_DIRECTIONS)),
    )
    return Plane(np.concatenate([s.normal for s in sources]), np.concatenate([s.offset for s in sources]))


def _upright_directions() -> Float[np.ndarray, "d 3"]:
    """Returns evenly spread normals of planes that are upright on the sheet z = 0."""
    angle = np.pi * np.arange(NUM_UPRIGHT_DIRECTIONS) / NUM_UPRIGHT_DIRECTIONS
    return np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)


def principal_planes(points: Float[np.ndarray, "n 3"]) -> Plane:
    """Returns the three planes through the mean that are normal to the principal axes."""
    mean = points.mean(axis=0)
    axes = np.linalg.eigh(np.cov(points.T))[1].T
    return Plane(axes, axes @ mean)


def pair_planes(surface: Surface, rng: np.random.Generator, count: int) -> Plane:
    """Returns the perpendicular bisectors of at most `count` pairs of points.

    The plane of a pair must also reflect the normal at one point onto the normal at the other. After Mitra, Guibas and
    Pauly, "Partial and approximate symmetry detection for 3D geometry", SIGGRAPH 2006, but from points and normals
    alone.
    """
    rows = rng.permutation(len(surface.points))[:NUM_PAIRED]
    i, j = np.triu_indices(len(rows), 1)
    step = surface.points[rows[j]] - surface.points[rows[i]]
    distance = np.linalg.norm(step, axis=1)
    far = distance > MIN_DISTANCE
    i, j, normal = rows[i[far]], rows[j[far]], step[far] / distance[far, None]
    reflected = surface.normals[i] - 2 * (surface.normals[i] * normal).sum(axis=1, keepdims=True) * normal
    matching = np.flatnonzero(np.abs((reflected * surface.normals[j]).sum(axis=1)) > MIN_COSINE)
    chosen = matching[_rare_directions_first(normal[matching], rng)[:count]]
    i, j, normal = i[chosen], j[chosen], normal[chosen]
    return Plane(normal, (normal * (surface.points[i] + surface.points[j])).sum(axis=1) / 2)


def _rare_directions_first(directions: Float[np.ndarray, "p 3"], rng: np.random.Generator) -> Int[np.ndarray, " p"]:
    """Returns the rows in a random order that favours rare directions.

    A flat or round part of the object has very many matching pairs, which share a few directions. Without this order
    they would crowd out the others.
    """
    bins = np.round(4 * directions * np.sign(directions[:, :1] + 1e-12)).astype(int)
    label = np.unique(bins, axis=0, return_inverse=True)[1].ravel()
    frequency = np.bincount(label)[label]
    return np.argsort(rng.random(len(directions)) * np.sqrt(frequency), kind="stable")


def even_planes(points: Float[np.ndarray, "n 3"], directions: Float[np.ndarray, "d 3"]) -> Plane:
    """Returns planes with each direction as the normal, at even offsets all the way through the cloud.

    Planes through the centre would not do: a missing part shifts every estimate of it.
    """
    sample = points[:: max(1, len(points) // 1000)]
    low, high = np.quantile(sample @ directions.T, [OUTER_FRACTION, 1 - OUTER_FRACTION], axis=0)
    count = ((high - low) / OFFSET_STEP).astype(int) + 1
    row = np.repeat(np.arange(len(directions)), count)
    step = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) - (count[row] - 1) / 2
    return Plane(directions[row], 0.5 * (low + high)[row] + OFFSET_STEP * step)
