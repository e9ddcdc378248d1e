"""The robust method: surface, candidates, scores, and the last digits of the plane."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from symjax.errors import InvalidArgumentError
from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.l2e.status import RESULTS, sentence
from symjax.method.result import Candidate, MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud
from symjax.robust.classification import judge
from symjax.robust.quadrics import Patches, patches
from symjax.robust.refinement import Polished, polish
from symjax.robust.scoring import Evidence, evidence, exactness
from symjax.robust.search import candidates, same
from symjax.robust.surface import Surface, surface
from symjax.robust.visibility import NUM_DIRECTIONS, find_viewpoint
from symjax.robust.voxel_grid import Lattice, lattice

MAX_POLISHED = 9
"""Candidates polished at most: a cube has nine planes."""

RIVAL = 0.85
"""Share of the best candidate's score from which on another one is polished too: it may be another mirror plane."""

INLIER_SHARE = 0.5
"""A point is an inlier where at least half of what it could say speaks for the plane."""

CHANCE, EXACT_SHARE = 0.4, 0.4
"""Exactness that rough symmetries reach by chance, by a few exact parts: below it says nothing. Weight, beside the
score, of what is above."""


@dataclass(frozen=True, kw_only=True)
class Robust:
    """Planes from many hypotheses, L2E with correspondences that follow the plane, and a verification on the cloud.

    Attributes:
        init: a plane to begin with beside all others, in the units of the given points.
    """

    name: ClassVar[str] = "robust"
    drops_outliers: ClassVar[bool] = True

    init: Plane | None = None

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError for an option out of its range; a plane's normal is divided by its length."""
        if self.init is not None:
            object.__setattr__(self, "init", _checked_plane(self.init))

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud, see `Method.find`."""
        prior = None if self.init is None else cloud.to_given.inverse().plane(self.init)
        with timer.stage("surface"):
            around = surface(cloud.points, normals=cloud.normals)
            viewpoint = None if around.flat else find_viewpoint(around, fibonacci(NUM_DIRECTIONS))
            cells = lattice(around, viewpoint)
        with timer.stage("searching"):
            planes = candidates(around, cells, rng, prior=prior)
        with timer.stage("refining"):
            local = patches(around)
            ranked, first, of_first = _polished(planes, around, local, cells)
        with timer.stage("classifying"):
            verdict = judge(ranked, around, local, cells)
        rows = np.flatnonzero(of_first.counts > 0)
        pairs = np.stack([rows, of_first.partner[rows]], axis=1)
        share = of_first.share[rows]
        return MethodResult(
            candidates=ranked[:max_planes],
            planes=verdict.planes[:max_planes],
            symmetry=verdict.symmetry,
            threshold=verdict.threshold,
            ambiguous=verdict.ambiguous,
            axis=verdict.axis,
            rows=pairs,
            weight=share,
            inlier_weight=INLIER_SHARE,
            inlier_fraction=float(np.sum(share >= INLIER_SHARE) / max(len(rows), 1)),
            sigma=first.sigma,
            converged=bool(np.asarray(first.solution.result == RESULTS.successful)),
            message=str(sentence(first.solution.result)),
            uncertainty=Uncertainty(first.covariance, first.tangents, np.zeros(3)),
            notes=() if viewpoint is None else ("the cloud is a scan from one side: what it hides was left open",),
        )


def _checked_plane(plane: Plane) -> Plane:
    try:
        normal, offset = (np.asarray(part, dtype=float) for part in plane)
    except (TypeError, ValueError):
        normal, offset = np.zeros(0), np.zeros(0)
    if normal.shape != (3,) or offset.shape != () or not np.isfinite([*normal, offset]).all() or not normal.any():
        raise InvalidArgumentError(f"init must be a plane (normal of shape (3,), offset), not {plane!r}")
    length = np.linalg.norm(normal)
    return Plane(normal / length, offset / length)


def _ranking_score(score: float, exact: float) -> float:
    """Agreement, and a share of exact agreement, which noise cannot blur."""
    return score + EXACT_SHARE * max(exact - CHANCE, 0.0)


def _polished(
    planes: tuple[Candidate, ...], around: Surface, local: Patches, cells: Lattice
) -> tuple[tuple[Candidate, ...], Polished, Evidence]:
    """The candidates, those that may be the best polished and weighed on all points; and the best one's details."""
    done: list[tuple[Candidate, Polished, Evidence]] = []
    for candidate in planes:
        if len(done) == MAX_POLISHED or (done and candidate.score < RIVAL * max(of.score for _, _, of in done)):
            break
        one = polish(candidate.plane, around, local)
        if not any(same(one.plane, other.plane) for _, other, _ in done):
            of_one = evidence(one.plane, around, cells)
            exact = exactness(one.plane, around, of_one, local)
            done.append((Candidate(one.plane, of_one.score, _ranking_score(of_one.score, exact), exact), one, of_one))
    done.sort(key=lambda entry: -entry[0].ranking_score)
    rest = [c for c in planes if not any(same(c.plane, one.plane) for _, one, _ in done)]
    rest.sort(key=lambda candidate: -candidate.score)
    return (*(candidate for candidate, _, _ in done), *rest), done[0][1], done[0][2]
