"""Search: from hypotheses to candidates. It ranks all hypotheses, registers the best, and scores what they become."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.method.result import Candidate
from symjax.robust import registration
from symjax.robust.duplicates import drop_duplicates
from symjax.robust.hypotheses import hypotheses
from symjax.robust.registration import Probes
from symjax.robust.sheet import upright
from symjax.robust.surface import Surface
from symjax.robust.verification.scoring import score_plane
from symjax.robust.voxel_grid import VoxelGrid

CHUNK_SIZE = 1024
"""Hypotheses are scored in chunks of this size, so that one size is compiled whatever their number."""


class Round(NamedTuple):
    """Settings of one round of the search, which registers and scores the best planes of the previous round.

    Attributes:
        num_probes: points that are reflected.
        num_planes: planes that are registered.
        sigmas: σ of each step of the registration, in diagonals.
        point_weight: see `registration.register`.
        scoring_sigma: σ of the scores after the registration, in diagonals.
    """

    num_probes: int
    num_planes: int
    sigmas: tuple[float, ...]
    point_weight: float
    scoring_sigma: float


RANKING_SIGMA = 0.04
"""σ of the scores that rank the hypotheses, in diagonals: the distance between their offsets."""

ROUNDS = (
    Round(256, 512, (0.05,) * 2 + (0.04,) * 2 + (0.03,) * 4, 0.3, 0.025),
    Round(1024, 64, (0.03,) * 6 + (0.02,) * 6 + (0.015,) * 12, 0.05, 0.015),
)
"""The first round registers many planes with few points, the second few planes with many. The true plane was among the
planes kept on all of 312 clouds (whole, cut, noisy or with outliers), and on 0.92 of 39 scans from one side."""

NUM_CANDIDATES = 24
"""Maximum number of candidates."""

NUM_SCORED_POINTS = 1000
"""Points on which the candidates are scored with exact neighbours. They are enough to order the candidates."""


def candidates(
    surface: Surface,
    grid: VoxelGrid,
    rng: np.random.Generator,
    *,
    num_pairs: int,
    init: Plane | None = None,
    flat: bool = False,
    register: bool = True,
    exact_scoring: bool = True,
    use_normals: bool = True,
) -> tuple[Candidate, ...]:
    """Finds the candidates: distinct planes that reflect the cloud onto itself best.

    Args:
        surface: the surface, in units of its diagonal.
        grid: the voxel grid around it.
        rng: random generator that draws pairs of points, and the points that are reflected.
        num_pairs: maximum number of hypotheses from pairs of points.
        init: an additional hypothesis; None for none.
        flat: whether all points and normals lie in the sheet z = 0; then all planes are upright on it.
        register: whether the hypotheses are registered; otherwise they are only scored, and the best are kept.
        exact_scoring: whether the candidates are scored with exact neighbours; otherwise their scores are those of the
            voxel grid.
        use_normals: whether the agreement includes the normal direction, in the registration and the scores.

    Returns:
        At most NUM_CANDIDATES candidates, the best first.
    """
    planes = hypotheses(surface, rng, num_pairs=num_pairs, flat=flat)
    if init is not None:
        planes = Plane(np.vstack([init.normal, planes.normal]), np.append(init.offset, planes.offset))
    order = rng.permutation(len(surface.points))
    device_grid = jax.device_put(grid)
    probes = _probes(surface, order, ROUNDS[0].num_probes)
    score = _grid_scores(planes, RANKING_SIGMA, probes, device_grid, use_normals)
    for settings in ROUNDS:
        probes = _probes(surface, order, settings.num_probes)
        best = np.argsort(-score, kind="stable")
        if settings is ROUNDS[0]:
            best = best[: settings.num_planes]
        else:
            best = drop_duplicates(planes, best, settings.num_planes)
        # if there are fewer planes, some are repeated: with fixed shapes, few sizes are compiled
        best = np.resize(best, settings.num_planes)
        planes = Plane(planes.normal[best], planes.offset[best])
        if register:
            planes = _registered(planes, settings, probes, device_grid, use_normals)
        score = _grid_scores(planes, settings.scoring_sigma, probes, device_grid, use_normals)
    kept = drop_duplicates(planes, np.argsort(-score, kind="stable"), NUM_CANDIDATES)
    if flat:  # rounding in single precision has turned them by about 1e-6
        planes = upright(planes)
    found = [Plane(planes.normal[i], planes.offset[i]) for i in kept]
    scores = score[kept].tolist()
    if exact_scoring:
        rows = order[:NUM_SCORED_POINTS]
        scores = [score_plane(plane, surface, grid, rows, use_normals=use_normals).score for plane in found]
    scored = (Candidate(plane, value, value) for plane, value in zip(found, scores, strict=True))
    return tuple(sorted(scored, key=lambda candidate: -candidate.score))


def _registered(planes: Plane, settings: Round, probes: Probes, grid: VoxelGrid, use_normals: bool) -> Plane:
    """Registers planes in single precision and returns them in double precision."""
    batch, sigmas = _as_batch(planes, slice(None)), np.array(settings.sigmas, np.float32)
    moved = registration.register(
        batch, sigmas, probes, grid, point_weight=settings.point_weight, use_normals=use_normals
    )
    normal, offset = (np.asarray(column, dtype=float) for column in moved)
    return Plane(normal / np.linalg.norm(normal, axis=1, keepdims=True), offset)


def _probes(surface: Surface, order: Int[np.ndarray, " n"], count: int) -> Probes:
    """Returns the first `count` points in an order; repeats points of a smaller cloud, so that the shape is fixed."""
    rows = np.resize(order, count)
    weight = surface.confidence[rows] / surface.confidence[rows].mean()
    columns = (surface.points[rows], surface.normals[rows], weight)
    return Probes(*(jnp.asarray(column.astype(np.float32)) for column in columns))


def _as_batch(planes: Plane, rows: Int[np.ndarray, " r"] | slice) -> Plane:
    """Returns some of the planes as JAX arrays in single precision."""
    return Plane(*(jnp.asarray(column[rows].astype(np.float32)) for column in planes))


def _grid_scores(
    planes: Plane, sigma: float, probes: Probes, grid: VoxelGrid, use_normals: bool
) -> Float[np.ndarray, " p"]:
    """Returns the scores of planes by the voxel grid; the last chunk repeats planes to fill up."""
    count = len(planes.offset)
    size = min(count, CHUNK_SIZE)
    chunks = np.resize(np.arange(count), (-(-count // size), size))
    scores = [
        registration.grid_scores(_as_batch(planes, rows), np.float32(sigma), probes, grid, use_normals=use_normals)
        for rows in chunks
    ]
    return np.concatenate([np.asarray(score) for score in scores])[:count]
