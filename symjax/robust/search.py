"""From a surface to its candidate planes: hypotheses are ranked, registered, and scored."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.method.result import Candidate
from symjax.robust import registration
from symjax.robust.distinct import distinct
from symjax.robust.hypotheses import hypotheses
from symjax.robust.registration import Probes
from symjax.robust.scoring import score_plane
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import VoxelGrid

CHUNK = 1024
"""Hypotheses are ranked in chunks of this size, whatever their number, so that one size is compiled."""


class Round(NamedTuple):
    """One round of the search: the best planes of the last round are registered and scored.

    Attributes:
        num_probes: points that are mirrored.
        kept: planes that are registered.
        sigmas: σ of every step of the registration, in diagonals.
        isotropic: see `register`.
        scoring_sigma: σ of the scores afterwards.
    """

    num_probes: int
    kept: int
    sigmas: tuple[float, ...]
    isotropic: float
    scoring_sigma: float


RANKING_SIGMA = 0.04
"""σ of the scores by which hypotheses are ranked, in diagonals: the distance of their offsets."""

ROUNDS = (
    Round(256, 512, (0.05,) * 2 + (0.04,) * 2 + (0.03,) * 4, 0.3, 0.025),
    Round(1024, 64, (0.03,) * 6 + (0.02,) * 6 + (0.015,) * 12, 0.05, 0.015),
)
"""Many planes on few points, then few planes on many. The true plane was among those kept on all of 312 clouds, whole,
cut, noisy or with outliers, and on 0.92 of 39 scans from one side."""

NUM_CANDIDATES = 24
"""Candidates that are scored with exact neighbours."""

NUM_SCORED_POINTS = 1000
"""Points that are enough to score them on."""


def candidates(
    surface: Surface,
    grid: VoxelGrid,
    rng: np.random.Generator,
    *,
    num_pairs: int,
    prior: Plane | None = None,
    register: bool = True,
    exact_scoring: bool = True,
    use_normals: bool = True,
) -> tuple[Candidate, ...]:
    """Distinct candidate planes, the best first.

    Args:
        surface: in units of its diagonal.
        grid: around it.
        rng: draws pairs of points, and the points that are mirrored.
        num_pairs: see `hypotheses`.
        prior: a plane to begin with, beside all others.
        register: whether the hypotheses are registered; if not, they are only scored and the best ones kept.
        exact_scoring: whether the candidates are scored with exact neighbours; if not, they keep their scores by
            the grid.
        use_normals: whether normals must agree in registration and scores.
    """
    planes = hypotheses(surface, rng, num_pairs=num_pairs)
    if prior is not None:
        planes = Plane(np.vstack([prior.normal, planes.normal]), np.append(prior.offset, planes.offset))
    order = rng.permutation(len(surface.points))
    on_device = jax.device_put(grid)
    score = _grid_scores(planes, RANKING_SIGMA, _probes(surface, order, ROUNDS[0].num_probes), on_device, use_normals)
    for stage in ROUNDS:
        probes = _probes(surface, order, stage.num_probes)
        best = np.argsort(-score, kind="stable")
        best = best[: stage.kept] if stage is ROUNDS[0] else distinct(planes, best, stage.kept)
        # if there are fewer, some are computed twice: in fixed shapes, few sizes are compiled
        best = np.resize(best, stage.kept)
        planes = Plane(planes.normal[best], planes.offset[best])
        if register:
            planes = _registered(planes, stage, probes, on_device, use_normals)
        score = _grid_scores(planes, stage.scoring_sigma, probes, on_device, use_normals)
    kept = distinct(planes, np.argsort(-score, kind="stable"), NUM_CANDIDATES)
    found = [Plane(planes.normal[i], planes.offset[i]) for i in kept]
    scores = score[kept].tolist()
    if exact_scoring:
        rows = order[:NUM_SCORED_POINTS]
        scores = [score_plane(plane, surface, grid, rows, use_normals=use_normals).score for plane in found]
    scored = (Candidate(plane, value, value) for plane, value in zip(found, scores, strict=True))
    return tuple(sorted(scored, key=lambda candidate: -candidate.score))


def _registered(planes: Plane, stage: Round, probes: Probes, grid: VoxelGrid, use_normals: bool) -> Plane:
    batch, sigmas = _as_batch(planes, slice(None)), np.array(stage.sigmas, np.float32)
    moved = registration.register(batch, sigmas, probes, grid, isotropic=stage.isotropic, use_normals=use_normals)
    normal, offset = (np.asarray(column, dtype=float) for column in moved)
    return Plane(normal / np.linalg.norm(normal, axis=1, keepdims=True), offset)


def _probes(surface: Surface, order: Int[np.ndarray, " n"], count: int) -> Probes:
    """The first points of an order; of a small cloud some twice, so that the shape is the same."""
    rows = np.resize(order, count)
    weight = surface.confidence[rows] / surface.confidence[rows].mean()
    columns = (surface.points[rows], surface.normals[rows], weight)
    return Probes(*(jnp.asarray(column.astype(np.float32)) for column in columns))


def _as_batch(planes: Plane, rows: Int[np.ndarray, " r"] | slice) -> Plane:
    return Plane(*(jnp.asarray(column[rows].astype(np.float32)) for column in planes))


def _grid_scores(
    planes: Plane, sigma: float, probes: Probes, grid: VoxelGrid, use_normals: bool
) -> Float[np.ndarray, " p"]:
    count = len(planes.offset)
    size = min(count, CHUNK)
    chunks = np.resize(np.arange(count), (-(-count // size), size))
    scores = [
        registration.grid_scores(_as_batch(planes, rows), np.float32(sigma), probes, grid, use_normals=use_normals)
        for rows in chunks
    ]
    return np.concatenate([np.asarray(score) for score in scores])[:count]
