"""The robust method on a cloud: surface, candidates, evidence, and the last digits."""

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.l2e import manifolds
from symjax.l2e.status import RESULTS, sentence
from symjax.method.result import Candidate, Finding
from symjax.method.timer import Stages
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


def find(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None,
    prior: Plane | None,
    max_planes: int,
    rng: np.random.Generator,
    stages: Stages,
) -> Finding:
    """Finds the mirror planes of a cloud in units of its diagonal.

    Args:
        points: distinct points without scattered outliers.
        normals: surface normals, of either orientation.
        prior: a plane to begin with, beside all others.
        max_planes: most candidates that are returned.
        rng: draws what is looked at.
        stages: clock of the stages.
    """
    with stages("surface"):
        around = surface(points, normals=normals)
        directions = np.asarray(manifolds.fibonacci(NUM_DIRECTIONS), dtype=float)
        viewpoint = None if around.flat else find_viewpoint(around, directions)
        cells = lattice(around, viewpoint)
    with stages("searching"):
        planes = candidates(around, cells, rng, prior=prior)
    with stages("polishing"):
        local = patches(around)
        ranked, first, of_first = _polished(planes, around, local, cells)
    with stages("judging"):
        verdict = judge(ranked, around, local, cells)
    rows = np.flatnonzero(of_first.counts > 0)
    pairs = np.stack([rows, of_first.partner[rows]], axis=1)
    share, counts = of_first.share[rows], of_first.counts[rows]
    return Finding(
        candidates=ranked[:max_planes],
        threshold=verdict.threshold,
        symmetry=verdict.symmetry,
        ambiguous=verdict.ambiguous,
        axis=verdict.axis,
        planes=verdict.planes[:max_planes],
        rows=pairs,
        weight=share,
        inlier_fraction=float(counts[share >= INLIER_SHARE].sum() / max(counts.sum(), 1e-12)),
        sigma=first.sigma,
        converged=bool(np.asarray(first.solution.result == RESULTS.successful)),
        message=str(sentence(first.solution.result)),
        uncertainty=Uncertainty(first.covariance, first.tangents, np.zeros(3)),
        notes=() if viewpoint is None else ("the cloud is a scan from one side: what it hides was left open",),
    )


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
            done.append((Candidate(one.plane, of_one.score, exact), one, of_one))
    done.sort(key=lambda entry: -entry[0].merit)
    rest = [c for c in planes if not any(same(c.plane, one.plane) for _, one, _ in done)]
    rest.sort(key=lambda candidate: -candidate.score)
    return (*(candidate for candidate, _, _ in done), *rest), done[0][1], done[0][2]
