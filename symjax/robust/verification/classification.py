"""Classification: which candidates are mirror planes, and what symmetry they make up.

`classify` makes these decisions in order:

1. The best candidate must exceed its threshold, and the cloud must not refute it. Otherwise the symmetry is "none".
2. Another candidate may be a mirror plane too if it exceeds its own threshold, its ranking score is not far below the
   best, the cloud does not refute it, and the score falls on the way to every better mirror plane. Candidates that are
   as good as the best are spared the last condition.
3. If the second of these planes is about as good as the first, the answer is ambiguous. It may then be a sample of the
   planes of a continuous symmetry. The line in which two candidates intersect is an axis if all planes through it score
   high and none of them is refuted.
4. If the planes through a line that is tilted to the axis score high too, the symmetry is a sphere. The line is taken
   through the common point of the mirror planes.

Only the planes that the cloud confirms are named. Without an axis, a plane that is ruled out is not counted as a rival.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry.local_frames import tangent_frames
from symjax.geometry.plane import Plane
from symjax.method.result import Axis, Candidate, Symmetry
from symjax.robust.duplicates import SAME_OFFSET
from symjax.robust.quadrics import Quadrics
from symjax.robust.surface import Surface
from symjax.robust.verification.contradiction import contradiction
from symjax.robust.verification.evidence import Evidence, is_refuted
from symjax.robust.verification.scoring import score_plane
from symjax.robust.verification.thresholds import FoundThresholds, background, relative_noise
from symjax.robust.voxel_grid import VoxelGrid

SECONDARY = 0.87
"""Fraction of the best ranking score above which another candidate may be a mirror plane. A missing part may have
reduced its score more than that of the best."""

AS_GOOD = 0.97
"""Fraction of the best ranking score above which another mirror plane is as good as the best."""

VALLEY = 0.95
"""Fraction of a candidate's own score below which the score must fall between it and every better mirror plane. A body
of revolution with a handle agrees with all planes through its axis nearly as well as with the plane through the handle.
They are not mirror planes, and no valley separates them from that one. Chosen on generated clouds; the columns
"correct kind" of `experiments.run calibration` show how often the remaining planes are right."""

NUM_BETWEEN = 6
"""Number of planes between two candidates that are scored to find a valley."""

AXIS_TRIALS = 8
"""Number of best candidates whose lines of intersection are tried as axes."""

AXIS_PLANES = 7
"""Number of planes through a line that must all score high for an axis. It is odd so that few regular prisms have all
of them as mirror planes."""

STILL_AS_GOOD = 0.94
"""Fraction of the best score above which a plane through an axis scores high. It is below AS_GOOD because these planes
are not refined."""

AS_GOOD_FLAT, STILL_AS_GOOD_FLAT = 0.92, 0.85
"""The same two fractions for an axis of a flat cloud, whose outline has few points: 0.94 and 0.92 on filled discs."""

NUM_POINTS = 1000
"""Number of points on which planes are scored here."""

EXCUSED_ON_AXIS = 0.5
"""See EXCUSED_BY_BOUNDARY in `contradiction`: on a body of revolution, only a cut excuses a plane through the axis. A
handle near the rim of a vessel is close to boundary points too. Measured on a saucepan: 0.35."""


class Classification(NamedTuple):
    """The symmetry that the candidates make up.

    Attributes:
        threshold: see `MethodResult`, as for the others.
        unconfirmed: number of planes that may be mirror planes too, but that the cloud does not confirm.
        refuted: whether the cloud refutes the best plane.
    """

    threshold: float
    symmetry: Symmetry
    ambiguous: bool
    axis: Axis | None
    planes: tuple[Plane, ...]
    unconfirmed: int = 0
    refuted: bool = False

    def none(self) -> "Classification":
        """Returns the classification of the same candidates if none of them is a mirror plane."""
        return Classification(self.threshold, "none", False, None, ())


def classify(
    ranked: tuple[Candidate, ...],
    evidence: Evidence,
    quadrics: Quadrics,
    grid: VoxelGrid,
    thresholds: FoundThresholds,
    *,
    outline: Surface | None = None,
    use_normals: bool = True,
) -> Classification:
    """Decides which candidates are mirror planes, and what symmetry they make up.

    Args:
        ranked: distinct candidates, the best first.
        evidence: the coarse evidence about the candidates, and the surface.
        quadrics: the quadrics of the surface.
        grid: the voxel grid around the surface.
        thresholds: the rule for the threshold.
        outline: outline of a flat cloud, on which its planes are scored; None for any other cloud.
        use_normals: see `score_plane`.
    """
    surface, best = evidence.surface if outline is None else outline, ranked[0]
    scorer = _Scorer(surface, grid, evidence.one_sided, use_normals)
    background_score, noise = background(ranked), relative_noise(surface, quadrics)
    limits = [float(thresholds.threshold(c.exactness or 0.0, background_score, noise)) for c in ranked]
    refuted = is_refuted(evidence.contradictions[0], one_sided=evidence.one_sided)
    if best.score <= limits[0] or refuted:
        return Classification(limits[0], "none", False, None, (), refuted=refuted)
    passing = [
        i
        for i, (c, limit) in enumerate(zip(ranked, limits, strict=True))
        if i == 0 or (c.score > limit and c.ranking_score > SECONDARY * best.ranking_score)
    ]
    verdicts = evidence.verdicts(passing)
    mirrors = _separated([i for i in passing if verdicts[i] != "refuted"], ranked, scorer)
    as_good, still = (AS_GOOD, STILL_AS_GOOD) if outline is None else (AS_GOOD_FLAT, STILL_AS_GOOD_FLAT)
    least, axis = max(limits[0], still * best.score), None
    if _is_ambiguous(mirrors, ranked, as_good):
        axis = _axis([c.plane for c in ranked if c.score > least][:AXIS_TRIALS], scorer, least)
    planes = tuple(ranked[i].plane for i in mirrors if verdicts[i] == "confirmed")
    if axis is None:
        mirrors = [i for i in mirrors if verdicts[i] != "ruled out"]
        kind: Symmetry = "one plane" if len(planes) == 1 else "several planes"
        unconfirmed = len(mirrors) - len(planes)
        return Classification(limits[0], kind, _is_ambiguous(mirrors, ranked), None, planes, unconfirmed)
    centre = _common_point([ranked[i].plane for i in mirrors])
    if scorer.all_exceed(_planes_through_line(centre, _tilted(axis[1])), least):
        return Classification(limits[0], "sphere", True, (centre, axis[1]), planes)
    return Classification(limits[0], "axis", True, axis, planes)


class _Scorer(NamedTuple):
    """Scores planes on about NUM_POINTS points of a surface, which are enough to compare planes."""

    surface: Surface
    grid: VoxelGrid
    one_sided: bool
    use_normals: bool

    def score(self, plane: Plane) -> float:
        rows = slice(None, None, max(1, len(self.surface.points) // NUM_POINTS))
        return score_plane(plane, self.surface, self.grid, rows, use_normals=self.use_normals).score

    def all_exceed(self, planes: list[Plane], least: float) -> bool:
        return all(self.score(plane) > least for plane in planes)

    def refutes_any(self, planes: list[Plane]) -> bool:
        for plane in planes:
            scored = score_plane(plane, self.surface, self.grid, use_normals=self.use_normals)
            found = contradiction(plane, self.surface, scored, one_sided=self.one_sided, excused=EXCUSED_ON_AXIS)
            if is_refuted(found, one_sided=self.one_sided):
                return True
        return False


def _is_ambiguous(ranks: list[int], ranked: Sequence[Candidate], as_good: float = AS_GOOD) -> bool:
    """Returns whether a second one of some candidates is about as good as the best."""
    return any(ranked[i].ranking_score >= as_good * ranked[0].ranking_score for i in ranks if i > 0)


def _separated(ranks: list[int], ranked: Sequence[Candidate], scorer: _Scorer) -> list[int]:
    """Returns the candidates that are as good as the best, or that a valley separates from every better one kept."""
    middle = scorer.surface.points.mean(axis=0)
    kept: list[int] = []
    for i in ranks:
        valley = VALLEY * scorer.score(ranked[i].plane)
        if ranked[i].ranking_score >= AS_GOOD * ranked[0].ranking_score or all(
            any(scorer.score(plane) < valley for plane in _planes_between(ranked[i].plane, ranked[j].plane, middle))
            for j in kept
        ):
            kept.append(i)
    return kept


def _planes_between(a: Plane, b: Plane, middle: Float[np.ndarray, " 3"]) -> Iterator[Plane]:
    """Yields planes between two planes, turning the shorter way about the line in which these intersect."""
    start, end = (np.append(plane.normal, plane.offset - plane.normal @ middle) for plane in (a, b))
    end = -end if start[:3] @ end[:3] < 0 else end
    for part in np.arange(1, NUM_BETWEEN + 1) / (NUM_BETWEEN + 1):
        normal, offset = np.split((1 - part) * start + part * end, [3])
        length = np.linalg.norm(normal)
        yield Plane(normal / length, offset[0] / length + normal @ middle / length)


def _common_point(planes: Sequence[Plane]) -> Float[np.ndarray, " 3"]:
    """Returns the point nearest to the planes by least squares, without those that miss the first solution."""
    normals, offsets = np.stack([p.normal for p in planes]), np.array([p.offset for p in planes])
    point = np.linalg.lstsq(normals, offsets)[0]
    near = np.abs(normals @ point - offsets) <= np.median(np.abs(normals @ point - offsets)) + SAME_OFFSET
    common: Float[np.ndarray, " 3"] = np.linalg.lstsq(normals[near], offsets[near])[0]
    return common


def _axis(planes: list[Plane], scorer: _Scorer, least: float) -> Axis | None:
    """Finds a line in which two of the planes intersect and through which all planes score more than `least`."""
    for a, b in combinations(planes, 2):
        direction = np.cross(a.normal, b.normal)
        length = float(np.linalg.norm(direction))
        if length < np.sin(np.radians(20)):
            continue  # the line of nearly parallel planes is too uncertain
        direction /= length
        point = np.linalg.solve(np.stack([a.normal, b.normal, direction]), np.array([a.offset, b.offset, 0.0]))
        through = _planes_through_line(point, direction)
        if scorer.all_exceed(through, least) and not scorer.refutes_any(through):
            return point, direction
    return None


def _planes_through_line(point: Float[np.ndarray, " 3"], direction: Float[np.ndarray, " 3"]) -> list[Plane]:
    """Returns AXIS_PLANES planes through a line, at even angles."""
    first, second = tangent_frames(direction).T
    turns = np.pi * (np.arange(AXIS_PLANES) + 0.5) / AXIS_PLANES
    normals = [np.cos(turn) * first + np.sin(turn) * second for turn in turns]
    return [Plane(normal, normal @ point) for normal in normals]


def _tilted(direction: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """Returns a direction at 45° to another. Planes through both lines coincide only by chance."""
    tilted: Float[np.ndarray, " 3"] = (direction + tangent_frames(direction)[:, 0]) / np.sqrt(2)
    return tilted
