"""Classification of a cloud's symmetry: none, one plane, several planes, or all planes through an axis or a centre."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry import checks
from symjax.geometry.local_frames import tangent_frames
from symjax.geometry.plane import Plane
from symjax.method.result import Axis, Candidate, Symmetry
from symjax.robust.distinct import SAME_OFFSET
from symjax.robust.quadrics import Quadrics
from symjax.robust.scoring import score_plane
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import VoxelGrid

BACKGROUND = slice(4, 12)
"""Ranks of the candidates whose median score is the background: the score of planes that are local optima on this cloud
and no symmetries. Compact round clouds agree with any plane through their middle to some extent."""

SECONDARY = 0.87
"""Share of the best ranking score above which another plane, above its threshold, is a mirror plane too: a missing part
may have taken more from it."""

AS_GOOD = 0.97
"""Share of the best ranking score above which another plane is as good."""

VALLEY = 0.95
"""Share of a plane's own score below which the score must fall somewhere on the way to every better plane. A body of
revolution with a handle agrees with all planes through its axis nearly as well as with the handle's: those are no
mirror planes but the shoulder of one. Chosen on generated clouds; the columns "named" of `experiments.run calibration`
show how often the planes that it leaves are right."""

NUM_BETWEEN = 6
"""Planes that are scored on the way."""

AXIS_TRIALS = 8
"""Best candidates whose intersections are tried as axes."""

AXIS_PLANES = 7
"""Planes through an axis that must all be as good: an odd number, so that few regular prisms have them all."""

STILL_AS_GOOD = 0.94
"""The same as AS_GOOD for planes that were not refined."""

NUM_POINTS = 1000
"""Points that are enough to score a plane here."""


@dataclass(frozen=True, kw_only=True)
class FoundThresholds:
    """The score above which a plane is a mirror plane.

    It is `base + per_background · background`, at most `most`; and `exact` for a plane whose exactness is above
    `exactness + exactness_per_noise · noise`. Chosen on generated objects and real models: `experiments.run
    calibration` prints the rates of right and wrong answers of these numbers and of others.

    Attributes:
        base: without any background.
        per_background: compact round clouds agree with any plane through their middle to some extent.
        most: whatever the background.
        exact: where mirror images lie on the surface as closely as its own points do, that is no chance.
        exactness: least exactness of such a plane, on a clean surface.
        exactness_per_noise: the noisier the surface, the more exactness is reached by chance.
    """

    base: float = 0.36
    per_background: float = 0.63
    most: float = 0.8
    exact: float = 0.4
    exactness: float = 0.5
    exactness_per_noise: float = 0.35

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError for a number that is negative or not finite."""
        for field in fields(self):
            checks.number(field.name, getattr(self, field.name), least=0)

    def threshold(self, exactness: Any, background: Any, noise: Any) -> Float[np.ndarray, "*n"]:
        """The score that a plane must exceed.

        Args:
            exactness: of the plane, or of an array of planes; 0 where it is not known.
            background: see `background`.
            noise: of the surface, see `relative_noise`.
        """
        usual = np.minimum(self.base + self.per_background * np.asarray(background), self.most)
        return np.where(exactness > self.exactness + self.exactness_per_noise * np.asarray(noise), self.exact, usual)


class Classification(NamedTuple):
    """What the candidates make up; see `MethodResult`."""

    threshold: float
    symmetry: Symmetry
    ambiguous: bool
    axis: Axis | None
    planes: tuple[Plane, ...]


def background(ranked: Sequence[Candidate]) -> float:
    """Median score of the candidates in the middle ranks; 0 if there are none."""
    return float(np.median([c.score for c in ranked[BACKGROUND]])) if len(ranked) > BACKGROUND.start else 0.0


def relative_noise(surface: Surface, quadrics: Quadrics) -> float:
    """The surface's own scatter in its tolerances."""
    return quadrics.scatter / surface.tolerance


def classify(
    ranked: tuple[Candidate, ...],
    surface: Surface,
    quadrics: Quadrics,
    grid: VoxelGrid,
    thresholds: FoundThresholds,
    *,
    use_normals: bool = True,
) -> Classification:
    """Decides whether there is a mirror plane, whether it is the only one, and what kind of symmetry several make up.

    Args:
        ranked: distinct candidates, the best first.
        surface: in units of its diagonal.
        quadrics: of the surface.
        grid: around the surface.
        thresholds: of the score.
        use_normals: see `score_plane`.
    """
    scorer = _Scorer(surface, grid, use_normals)
    best = ranked[0]
    others, noise = background(ranked), relative_noise(surface, quadrics)
    limits = [float(thresholds.threshold(c.exactness or 0.0, others, noise)) for c in ranked]
    if best.score <= limits[0]:
        return Classification(limits[0], "none", False, None, ())
    mirrors = [
        c
        for c, limit in zip(ranked, limits, strict=True)
        if c.score > limit and c.ranking_score > SECONDARY * best.ranking_score
    ]
    mirrors = _peaks(mirrors, scorer)
    planes = tuple(c.plane for c in mirrors)
    if len(mirrors) == 1:
        return Classification(limits[0], "one plane", False, None, planes)
    if mirrors[1].ranking_score < AS_GOOD * best.ranking_score:
        return Classification(limits[0], "several planes", False, None, planes)
    least = max(limits[0], STILL_AS_GOOD * best.score)
    axis = _axis([c.plane for c in ranked if c.score > least][:AXIS_TRIALS], scorer, least)
    if axis is None:
        return Classification(limits[0], "several planes", True, None, planes)
    centre = _common_point(planes)
    if scorer.all_exceed(_through_line(centre, _tilted(axis[1])), least):
        return Classification(limits[0], "sphere", True, (centre, axis[1]), planes)
    return Classification(limits[0], "axis", True, axis, planes)


class _Scorer(NamedTuple):
    """Scores planes on some points of a surface, which are enough to compare planes."""

    surface: Surface
    grid: VoxelGrid
    use_normals: bool

    def score(self, plane: Plane) -> float:
        rows = slice(None, None, max(1, len(self.surface.points) // NUM_POINTS))
        return score_plane(plane, self.surface, self.grid, rows, use_normals=self.use_normals).score

    def all_exceed(self, planes: list[Plane], least: float) -> bool:
        return all(self.score(plane) > least for plane in planes)


def _peaks(ranked: list[Candidate], scorer: _Scorer) -> list[Candidate]:
    """The candidates that are as good as the best, or peaks of their own."""
    middle = scorer.surface.points.mean(axis=0)
    kept: list[Candidate] = []
    for candidate in ranked:
        valley = VALLEY * scorer.score(candidate.plane)
        if candidate.ranking_score >= AS_GOOD * ranked[0].ranking_score or all(
            any(scorer.score(plane) < valley for plane in _between(candidate.plane, better.plane, middle))
            for better in kept
        ):
            kept.append(candidate)
    return kept


def _between(a: Plane, b: Plane, middle: Float[np.ndarray, " 3"]) -> Iterator[Plane]:
    """Planes on the shorter way from one to the other, turning about the line in which they meet."""
    start, end = (np.append(plane.normal, plane.offset - plane.normal @ middle) for plane in (a, b))
    end = -end if start[:3] @ end[:3] < 0 else end
    for part in np.arange(1, NUM_BETWEEN + 1) / (NUM_BETWEEN + 1):
        normal, offset = np.split((1 - part) * start + part * end, [3])
        length = np.linalg.norm(normal)
        yield Plane(normal / length, offset[0] / length + normal @ middle / length)


def _common_point(planes: tuple[Plane, ...]) -> Float[np.ndarray, " 3"]:
    """The point nearest to all planes by least squares; then again without the planes that miss it."""
    normals, offsets = np.stack([p.normal for p in planes]), np.array([p.offset for p in planes])
    point = np.linalg.lstsq(normals, offsets)[0]
    near = np.abs(normals @ point - offsets) <= np.median(np.abs(normals @ point - offsets)) + SAME_OFFSET
    return np.linalg.lstsq(normals[near], offsets[near])[0]


def _axis(planes: list[Plane], scorer: _Scorer, least: float) -> Axis | None:
    """The line in which two of the planes meet, if all planes through the line are as good; None if there is none."""
    for a, b in combinations(planes, 2):
        direction = np.cross(a.normal, b.normal)
        length = float(np.linalg.norm(direction))
        if length < np.sin(np.radians(20)):
            continue  # nearly parallel planes do not fix a line
        direction /= length
        point = np.linalg.solve(np.stack([a.normal, b.normal, direction]), np.array([a.offset, b.offset, 0.0]))
        if scorer.all_exceed(_through_line(point, direction), least):
            return point, direction
    return None


def _through_line(point: Float[np.ndarray, " 3"], direction: Float[np.ndarray, " 3"]) -> list[Plane]:
    """Planes through a line, at even angles."""
    first, second = tangent_frames(direction).T
    turns = np.pi * (np.arange(AXIS_PLANES) + 0.5) / AXIS_PLANES
    normals = [np.cos(turn) * first + np.sin(turn) * second for turn in turns]
    return [Plane(normal, normal @ point) for normal in normals]


def _tilted(direction: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """A direction well off another: planes about it are planes about the other only by chance."""
    return (direction + tangent_frames(direction)[:, 0]) / np.sqrt(2)
