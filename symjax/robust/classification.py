"""What the planes of a cloud make up: none, one plane, several, or all planes through an axis or a centre."""

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane
from symjax.method.result import Axis, Candidate, Symmetry
from symjax.robust.quadrics import Patches
from symjax.robust.scoring import evidence
from symjax.robust.search import SAME_OFFSET
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import Lattice

EXACT, EXACT_PER_NOISE, EXACT_LEAST = 0.5, 0.35, 0.4
"""Exactness from which on a score above EXACT_LEAST is enough: where mirror images lie on the surface as closely as
its own points do, that is no chance. The noisier the surface, the more chance there is: EXACT, and EXACT_PER_NOISE
times the surface's own scatter in its tolerances."""

LEAST, PER_BACKGROUND, MOST = 0.36, 0.63, 0.8
"""Threshold of the score otherwise: LEAST and PER_BACKGROUND times the background, at most MOST.
Chosen on generated objects and real models; `experiments.run calibration` prints the rates of right and wrong answers that
they and others give."""

BACKGROUND = slice(4, 12)
"""Ranks of the candidates whose median score is the background: what planes score on this cloud that are local optima
and no symmetries. Compact round clouds agree with any plane through their middle to some extent."""

HOLDS = 0.87
"""Share of the best merit from which on another plane above its threshold is a mirror plane too: one that a missing
part has taken more from."""

AS_GOOD = 0.97
"""Share of the best merit from which on another plane is as good."""

VALLEY = 0.95
"""Share of a plane's own score below which that of the planes on the way to every better one must fall somewhere. A
body of revolution with a handle agrees with all planes through its axis nearly as well as with the handle's: those are
no mirror planes but the shoulder of one. Chosen on generated clouds; "named" in `experiments.run calibration` says how
often what it leaves is right."""

WAY = 6
"""Planes that are looked at on the way."""

AXIS_TRIALS = 8
"""Best candidates whose intersections are tried as axes."""

AXIS_PLANES = 7
"""Planes through an axis that must all be as good: an odd number, so that few regular prisms have them all."""

STILL_AS_GOOD = 0.94
"""The same for planes that were not polished."""

NUM_POINTS = 1000


class Verdict(NamedTuple):
    """What the planes make up; see `Finding`."""

    threshold: float
    symmetry: Symmetry
    ambiguous: bool
    axis: Axis | None
    planes: tuple[Plane, ...]


def judge(ranked: tuple[Candidate, ...], surface: Surface, around: Patches, lattice: Lattice) -> Verdict:
    """Whether there is a mirror plane, whether it is the only one, and of what kind several are.

    Args:
        ranked: distinct candidates, the best first.
        surface: in units of its diagonal.
        around: its patches.
        lattice: around it.
    """
    best = ranked[0]
    exact = EXACT + EXACT_PER_NOISE * around.scatter / surface.tolerance
    background = float(np.median([c.score for c in ranked[BACKGROUND]])) if len(ranked) > BACKGROUND.start else 0.0

    def threshold(candidate: Candidate) -> float:
        if (candidate.exactness or 0.0) > exact:
            return EXACT_LEAST
        return min(LEAST + PER_BACKGROUND * background, MOST)

    if best.score <= threshold(best):
        return Verdict(threshold(best), "none", False, None, ())
    holding = [c for c in ranked if c.score > threshold(c) and c.ranking_score > HOLDS * best.ranking_score]
    holding = _separate(holding, surface, lattice)
    planes = tuple(c.plane for c in holding)
    if len(holding) == 1:
        return Verdict(threshold(best), "one plane", False, None, planes)
    if holding[1].ranking_score < AS_GOOD * best.ranking_score:
        return Verdict(threshold(best), "several planes", False, None, planes)
    least = max(threshold(best), STILL_AS_GOOD * best.score)
    axis = _axis([c.plane for c in ranked if c.score > least][:AXIS_TRIALS], surface, lattice, least)
    if axis is None:
        return Verdict(threshold(best), "several planes", True, None, planes)
    centre = _common_point(planes)
    tilted = _all_as_good(_about(centre, _tilted(axis[1])), surface, lattice, least)
    if tilted:
        axis = centre, axis[1]
    return Verdict(threshold(best), "sphere" if tilted else "axis", True, axis, planes)


def _separate(ranked: list[Candidate], surface: Surface, lattice: Lattice) -> list[Candidate]:
    """Those that are as good as the best, or peaks of their own."""
    rows = _some(surface)
    kept: list[Candidate] = []
    for candidate in ranked:
        own = evidence(candidate.plane, surface, lattice, rows).score
        if candidate.ranking_score >= AS_GOOD * ranked[0].ranking_score or all(
            any(
                evidence(plane, surface, lattice, rows).score < VALLEY * own
                for plane in _between(candidate.plane, better.plane, surface.points.mean(axis=0))
            )
            for better in kept
        ):
            kept.append(candidate)
    return kept


def _between(a: Plane, b: Plane, middle: Float[np.ndarray, "3"]) -> Iterator[Plane]:
    """Planes on the shorter way from one to the other, turning about the line in which they meet."""
    start, end = (np.append(plane.normal, plane.offset - plane.normal @ middle) for plane in (a, b))
    end = -end if start[:3] @ end[:3] < 0 else end
    for part in np.arange(1, WAY + 1) / (WAY + 1):
        normal, offset = np.split((1 - part) * start + part * end, [3])
        length = np.linalg.norm(normal)
        yield Plane(normal / length, offset[0] / length + normal @ middle / length)


def _common_point(planes: tuple[Plane, ...]) -> Float[np.ndarray, "3"]:
    """The point nearest to all planes, by least squares, and once more without those that miss it."""
    normals, offsets = np.stack([p.normal for p in planes]), np.array([p.offset for p in planes])
    point = np.linalg.lstsq(normals, offsets)[0]
    near = np.abs(normals @ point - offsets) <= np.median(np.abs(normals @ point - offsets)) + SAME_OFFSET
    return np.linalg.lstsq(normals[near], offsets[near])[0]


def _axis(planes: list[Plane], surface: Surface, lattice: Lattice, least: float) -> Axis | None:
    """The line in which two of the planes meet, all planes through which are as good; None if there is none."""
    for a, b in combinations(planes, 2):
        direction = np.cross(a.normal, b.normal)
        length = float(np.linalg.norm(direction))
        if length < np.sin(np.radians(20)):
            continue  # nearly parallel planes do not fix a line
        direction /= length
        point = np.linalg.solve(np.stack([a.normal, b.normal, direction]), np.array([a.offset, b.offset, 0.0]))
        if _all_as_good(_about(point, direction), surface, lattice, least):
            return point, direction
    return None


def _about(point: Float[np.ndarray, "3"], direction: Float[np.ndarray, "3"]) -> list[Plane]:
    """Planes through a line, at even angles."""
    first = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    first /= np.linalg.norm(first)
    second = np.cross(direction, first)
    turns = np.pi * (np.arange(AXIS_PLANES) + 0.5) / AXIS_PLANES
    normals = [np.cos(turn) * first + np.sin(turn) * second for turn in turns]
    return [Plane(normal, normal @ point) for normal in normals]


def _tilted(direction: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3"]:
    """A direction well off another: planes about it are planes about the other only by chance."""
    across = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
    return (direction + across / np.linalg.norm(across)) / np.sqrt(2)


def _all_as_good(planes: list[Plane], surface: Surface, lattice: Lattice, least: float) -> bool:
    return all(evidence(plane, surface, lattice, _some(surface)).score > least for plane in planes)


def _some(surface: Surface) -> slice:
    """Rows that are enough to weigh a plane by."""
    return slice(None, None, max(1, len(surface.points) // NUM_POINTS))
