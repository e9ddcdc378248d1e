"""From a surface to its candidate planes: hypotheses screened, registered, and weighed."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import is_same, suppress
from symjax.method.result import Candidate
from symjax.robust.hypotheses import NUM_DIRECTIONS, hypotheses
from symjax.robust.registration import Planes, Probes, agreement, register
from symjax.robust.scoring import evidence
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import Lattice

CHUNK = 1024
"""Hypotheses are screened so many at a time, whatever their number, so that one size is compiled."""


class Round(NamedTuple):
    """One round of the search: the best planes of the last are registered with these σ, and again the best are kept.

    Attributes:
        num_probes: points that are mirrored.
        kept: planes that are registered.
        sigmas: σ of every step, in diagonals.
        isotropic: see `register`.
        weighed: σ at which the planes are weighed afterwards.
    """

    num_probes: int
    kept: int
    sigmas: tuple[float, ...]
    isotropic: float
    weighed: float


SCREEN_SIGMA = 0.04
ROUNDS = (
    Round(256, 512, (0.05,) * 2 + (0.04,) * 2 + (0.03,) * 4, 0.3, 0.025),
    Round(1024, 64, (0.03,) * 6 + (0.02,) * 6 + (0.015,) * 12, 0.05, 0.015),
)
"""Many planes on few points, then few planes on many. The true plane was among those kept on all of 312 clouds, whole,
cut, noisy or with outliers, and on 0.92 of 39 scans from one side."""

SAME_ANGLE, SAME_OFFSET = 4.0, 0.02
"""Planes nearer than this (degrees, diagonals) are one candidate."""

NUM_WEIGHED = 24
"""Candidates that are weighed with exact neighbours."""

NUM_WEIGHED_POINTS = 1000


def candidates(
    surface: Surface, lattice: Lattice, rng: np.random.Generator, *, prior: Plane | None = None
) -> tuple[Candidate, ...]:
    """Distinct candidate planes, the best first.

    Args:
        surface: in units of its diagonal.
        lattice: around it.
        rng: draws the points that are looked at.
        prior: a plane to begin with, beside all others.
    """
    planes = hypotheses(surface, fibonacci(NUM_DIRECTIONS), rng)
    if prior is not None:
        planes = Plane(np.vstack([prior.normal, planes.normal]), np.append(prior.offset, planes.offset))
    order = rng.permutation(len(surface.points))
    cells = jax.device_put(lattice)
    score = _agreement(planes, SCREEN_SIGMA, _probes(surface, order, ROUNDS[0].num_probes), cells)
    for stage in ROUNDS:
        probes = _probes(surface, order, stage.num_probes)
        best = np.argsort(-score, kind="stable")
        best = best[: stage.kept] if stage is ROUNDS[0] else _distinct(planes, best, stage.kept)
        moved = register(
            _as_batch(planes, np.resize(best, stage.kept)),
            np.array(stage.sigmas, np.float32),
            probes,
            cells,
            isotropic=stage.isotropic,
        )
        planes = Plane(np.asarray(moved.v, dtype=float), np.asarray(moved.omega, dtype=float))
        planes = Plane(planes.normal / np.linalg.norm(planes.normal, axis=1, keepdims=True), planes.offset)
        score = _agreement(planes, stage.weighed, probes, cells)
    kept = _distinct(planes, np.argsort(-score, kind="stable"), NUM_WEIGHED)
    found = [Plane(planes.normal[i], planes.offset[i]) for i in kept]
    rows = order[:NUM_WEIGHED_POINTS]
    scores = (evidence(plane, surface, lattice, rows).score for plane in found)
    weighed = (Candidate(plane, score, score) for plane, score in zip(found, scores, strict=True))
    return tuple(sorted(weighed, key=lambda candidate: -candidate.score))


def _probes(surface: Surface, order: Int[np.ndarray, "n"], count: int) -> Probes:
    """The first points of an order; of a small cloud some twice, so that the shape is the same."""
    rows = np.resize(order, count)
    weight = surface.trust[rows] / surface.trust[rows].mean()
    columns = (surface.points[rows], surface.normals[rows], weight)
    return Probes(*(jnp.asarray(column.astype(np.float32)) for column in columns))


def _as_batch(planes: Plane, rows: Int[np.ndarray, "r"]) -> Planes:
    return Planes(*(jnp.asarray(column[rows].astype(np.float32)) for column in planes))


def _agreement(planes: Plane, sigma: float, probes: Probes, lattice: Lattice) -> Float[np.ndarray, "p"]:
    count = len(planes.offset)
    size = min(count, CHUNK)
    scores = [
        np.asarray(agreement(_as_batch(planes, rows), np.float32(sigma), probes, lattice))
        for rows in np.resize(np.arange(count), (-(-count // size), size))
    ]
    return np.concatenate(scores)[:count]


def same(a: Plane, b: Plane) -> bool:
    """Whether two planes are one candidate."""
    return is_same(a, b, angle=SAME_ANGLE, offset=SAME_OFFSET)


def _distinct(planes: Plane, order: Int[np.ndarray, "p"], most: int) -> Int[np.ndarray, "r"]:
    return suppress(planes, order, angle=SAME_ANGLE, offset=SAME_OFFSET, most=most)
