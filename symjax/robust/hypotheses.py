"""Planes to begin with, from three independent sources."""

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane
from symjax.robust.surface import Surface

NUM_DIRECTIONS, OFFSET_STEP = 400, 0.04
"""Directions over half the sphere, 7° apart, and distance of their offsets in diagonals: steps that a registration
whose σ starts at 0.05 crosses."""

OUTER_SHARE = 0.02
"""Offsets stop where so small a share of the cloud lies beyond: a plane through a cloud cut in half is at its end."""

NUM_PAIRED = 512
"""Points that are paired with each other."""

LIKE_NORMALS = 0.95
"""Least cosine between a normal and its partner's mirrored one in a pair that becomes a hypothesis: 18°, the error of a
noisy normal."""

LEAST_DISTANCE = 0.1
"""Least distance of the two points of a pair in diagonals: the plane of a nearer pair is too uncertain."""


def hypotheses(surface: Surface, rng: np.random.Generator, *, num_pairs: int) -> Plane:
    """Principal planes, planes of pairs of like points, and planes of even directions at several offsets.

    Args:
        surface: in units of its diagonal.
        rng: draws the pairs.
        num_pairs: most planes from pairs; 0 for none.
    """
    sources = (
        principal(surface.points),
        paired(surface, rng, num_pairs),
        directed(surface.points, fibonacci(NUM_DIRECTIONS)),
    )
    return Plane(np.concatenate([s.normal for s in sources]), np.concatenate([s.offset for s in sources]))


def principal(points: Float[np.ndarray, "n 3"]) -> Plane:
    """The three planes through the mean that the principal axes are normal to."""
    mean = points.mean(axis=0)
    axes = np.linalg.eigh(np.cov(points.T))[1].T
    return Plane(axes, axes @ mean)


def paired(surface: Surface, rng: np.random.Generator, count: int) -> Plane:
    """At most `count` planes between two points whose normals the plane mirrors onto each other.

    Mitra, Guibas and Pauly, "Partial and approximate symmetry detection for 3D geometry", SIGGRAPH 2006, from two
    points and their normals alone.
    """
    rows = rng.permutation(len(surface.points))[:NUM_PAIRED]
    i, j = np.triu_indices(len(rows), 1)
    step = surface.points[rows[j]] - surface.points[rows[i]]
    distance = np.linalg.norm(step, axis=1)
    long = distance > LEAST_DISTANCE
    i, j, step = rows[i[long]], rows[j[long]], step[long] / distance[long, None]
    mirrored = surface.normals[i] - 2 * (surface.normals[i] * step).sum(axis=1, keepdims=True) * step
    like = np.flatnonzero(np.abs((mirrored * surface.normals[j]).sum(axis=1)) > LIKE_NORMALS)
    # a flat or round part agrees with itself in countless pairs: those of rare normals say more
    chosen = _evenly_over_directions(step[like], rng)[:count]
    step, i, j = step[like][chosen], i[like][chosen], j[like][chosen]
    return Plane(step, (step * (surface.points[i] + surface.points[j])).sum(axis=1) / 2)


def _evenly_over_directions(step: Float[np.ndarray, "p 3"], rng: np.random.Generator) -> Int[np.ndarray, " p"]:
    """All rows in a random order in which rows of rare directions come early."""
    cell = np.unique(np.round(4 * step * np.sign(step[:, :1] + 1e-12)).astype(int), axis=0, return_inverse=True)[1]
    crowding = np.bincount(cell.ravel())[cell.ravel()]
    return np.argsort(rng.random(len(step)) * np.sqrt(crowding), kind="stable")


def directed(points: Float[np.ndarray, "n 3"], directions: Float[np.ndarray, "d 3"]) -> Plane:
    """Every direction with offsets all the way through the cloud, since a missing part shifts every centre."""
    sample = points[:: max(1, len(points) // 1000)]
    low, high = np.quantile(sample @ directions.T, [OUTER_SHARE, 1 - OUTER_SHARE], axis=0)
    count = ((high - low) / OFFSET_STEP).astype(int) + 1
    row = np.repeat(np.arange(len(directions)), count)
    step = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) - (count[row] - 1) / 2
    return Plane(directions[row], 0.5 * (low + high)[row] + OFFSET_STEP * step)
