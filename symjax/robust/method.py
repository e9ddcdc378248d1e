"""The robust method: surface, candidates, scores, refinement and classification."""

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from symjax.errors import InvalidArgumentError
from symjax.geometry import checks
from symjax.geometry.plane import Plane
from symjax.method.result import Candidate, MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud
from symjax.robust.classification import FoundThresholds, classify
from symjax.robust.distinct import is_same_candidate
from symjax.robust.quadrics import Quadrics, fit_quadrics
from symjax.robust.scoring import PlaneScore, exactness, score_plane
from symjax.robust.surface import Surface, estimate_surface
from symjax.robust.visibility import find_viewpoint
from symjax.robust.voxel_grid import VoxelGrid, voxel_grid

if TYPE_CHECKING:
    from symjax.robust.refinement import Refinement


@dataclass(frozen=True, kw_only=True)
class Robust:
    """Planes from many hypotheses, L2E with correspondences that follow the plane, and a verification on the cloud.

    Every stage can be left out, and every number that an ablation or a calibration changes is an option:
    `dataclasses.replace(Robust(), register=False)`. The defaults are the method.

    Attributes:
        init: a plane to begin with beside all others, in the units of the given points.
        use_point_confidence: whether points that do not fit their neighbours' tangent planes weigh less: they are
            outliers, or lie on edges. If not, all weigh the same.
        use_visibility: whether a scan from one side is recognised and what it could not see is left open.
        boundary_penalty: non-match penalty where the surface ends, 0 to 1: a part that was not scanned counts neither
            for a plane nor against it. 1 is the penalty inside the surface.
        use_normals: whether mirror images must agree with the surface's normals, in registration and scores: beside a
            surface, and across thin parts, the nearest point has another normal.
        num_pair_hypotheses: most hypotheses from pairs of points; 0 for none. On 36 generated clouds (whole, noisy, and
            cut among outliers) at least 1 of 1024, and 17 on the median, was within 8° and 0.03 diagonals of the true
            plane, from where the registration reaches it.
        register: whether hypotheses are moved to the optimum of the L2E criterion before they are compared: those of
            even directions are 7° and 0.04 diagonals apart.
        exact_scoring: whether candidates are ranked by scores with exact neighbours; if not, by those of the voxel
            grid, whose neighbours are off by up to a voxel's diagonal.
        max_refined: most candidates that are refined: a cube has nine planes.
        refine_above: share of the best candidate's score above which another one is refined too: it may be another
            mirror plane.
        refine: whether candidates take the refined plane; if not, they keep their own, with the standard errors and σ
            of the refinement.
        use_exactness: whether exactness counts in ranking and classification; if not, it is not computed.
        exactness_weight: weight of the exactness above `chance_exactness` in the ranking score, beside the score:
            exact agreement is rare by chance, and noise, which blurs the score, does not blur it.
        chance_exactness: exactness that rough symmetries reach by chance, by a few exact parts: below, it says nothing.
        inlier_agreement: agreement above which a pair is an inlier: at least half of what is possible.
        found: the score above which a plane is a mirror plane.

    Example:
        >>> import dataclasses
        >>> dataclasses.replace(Robust(), refine=False).max_refined
        9
    """

    name: ClassVar[str] = "robust"
    drops_outliers: ClassVar[bool] = True

    init: Plane | None = None
    use_point_confidence: bool = True
    use_visibility: bool = True
    boundary_penalty: float = 0.15
    use_normals: bool = True
    num_pair_hypotheses: int = 1024
    register: bool = True
    exact_scoring: bool = True
    max_refined: int = 9
    refine_above: float = 0.85
    refine: bool = True
    use_exactness: bool = True
    exactness_weight: float = 0.4
    chance_exactness: float = 0.4
    inlier_agreement: float = 0.5
    found: FoundThresholds = field(default_factory=FoundThresholds)

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError for an option out of its range; a plane's normal is divided by its length."""
        if self.init is not None:
            object.__setattr__(self, "init", _checked_plane(self.init))
        for name in ("boundary_penalty", "refine_above", "chance_exactness", "inlier_agreement"):
            checks.number(name, getattr(self, name), least=0, most=1)
        checks.number("exactness_weight", self.exactness_weight, least=0)
        checks.whole("num_pair_hypotheses", self.num_pair_hypotheses, 0)
        checks.whole("max_refined", self.max_refined, 1)
        for switch in fields(self):
            if isinstance(switch.default, bool):
                checks.flag(switch.name, getattr(self, switch.name))
        if not isinstance(self.found, FoundThresholds):
            raise InvalidArgumentError(f"found must be FoundThresholds, not {self.found!r}")

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud, see `Method.find`."""
        # JAX is imported when it is needed
        from symjax.robust.search import candidates

        prior = None if self.init is None else cloud.to_given.inverse().plane(self.init)
        with timer.stage("surface"):
            surface = estimate_surface(cloud.points, normals=cloud.normals, use_confidence=self.use_point_confidence)
            viewpoint = find_viewpoint(surface) if self.use_visibility and not surface.flat else None
            grid = voxel_grid(surface, viewpoint, boundary_penalty=self.boundary_penalty)
        with timer.stage("searching"):
            searched = candidates(
                surface,
                grid,
                rng,
                num_pairs=self.num_pair_hypotheses,
                prior=prior,
                register=self.register,
                exact_scoring=self.exact_scoring,
                use_normals=self.use_normals,
            )
        with timer.stage("refining"):
            quadrics = fit_quadrics(surface)
            refined, rest = self._refined(searched, surface, quadrics, grid)
        with timer.stage("classifying"):
            ranked = (*(one.candidate for one in refined), *rest)
            symmetry = classify(ranked, surface, quadrics, grid, self.found, use_normals=self.use_normals)
        best, scored = refined[0].refinement, refined[0].scored
        rows = np.flatnonzero(scored.weight > 0)
        agreement = scored.agreement[rows]
        return MethodResult(
            candidates=ranked,
            planes=symmetry.planes,
            symmetry=symmetry.symmetry,
            threshold=symmetry.threshold,
            ambiguous=symmetry.ambiguous,
            axis=symmetry.axis,
            rows=np.stack([rows, scored.partner[rows]], axis=1),
            weight=agreement,
            inlier_weight=self.inlier_agreement,
            inlier_fraction=float(np.sum(agreement >= self.inlier_agreement) / max(len(rows), 1)),
            sigma=best.sigma,
            converged=best.converged,
            message=best.message,
            uncertainty=best.uncertainty,
            notes=() if viewpoint is None else ("the cloud is a scan from one side: what it hides was left open",),
        )

    def _refined(
        self, searched: tuple[Candidate, ...], surface: Surface, quadrics: Quadrics, grid: VoxelGrid
    ) -> tuple[list["_Refined"], list[Candidate]]:
        """The candidates that may be the best, refined and scored on all points; and the others; the best first."""
        from symjax.robust.refinement import refine

        done: list[_Refined] = []
        for candidate in searched:
            if len(done) == self.max_refined:
                break
            if done and candidate.score < self.refine_above * max(one.candidate.score for one in done):
                break
            refinement = refine(candidate.plane, surface, quadrics)
            plane = refinement.plane if self.refine else candidate.plane
            if any(is_same_candidate(plane, one.candidate.plane) for one in done):
                continue
            scored = score_plane(plane, surface, grid, use_normals=self.use_normals)
            exact = exactness(plane, surface, scored, quadrics) if self.use_exactness else None
            ranking_score = self._ranking_score(scored.score, exact)
            done.append(_Refined(Candidate(plane, scored.score, ranking_score, exact), refinement, scored))
        done.sort(key=lambda one: -one.candidate.ranking_score)
        rest = [c for c in searched if not any(is_same_candidate(c.plane, one.candidate.plane) for one in done)]
        rest.sort(key=lambda candidate: -candidate.score)
        return done, rest

    def _ranking_score(self, score: float, exact: float | None) -> float:
        """The score, and a share of exact agreement."""
        return score + self.exactness_weight * max((exact or 0.0) - self.chance_exactness, 0.0)


class _Refined(NamedTuple):
    """A refined candidate, its refinement, and its score on all points."""

    candidate: Candidate
    refinement: "Refinement"
    scored: PlaneScore


class _InitialPlane(Plane):
    """A plane that compares and hashes by its numbers, so that methods do too; arrays do neither."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Plane) and all(map(np.array_equal, self, other))

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash((*self.normal.tolist(), float(self.offset)))


def _checked_plane(plane: Plane) -> Plane:
    try:
        normal, offset = (np.asarray(part, dtype=float) for part in plane)
    except (TypeError, ValueError):
        normal, offset = np.zeros(0), np.zeros(0)
    if normal.shape != (3,) or offset.shape != () or not np.isfinite([*normal, offset]).all() or not normal.any():
        raise InvalidArgumentError(f"init must be a plane (normal of shape (3,), offset), not {plane!r}")
    length = np.linalg.norm(normal)
    return _InitialPlane(normal / length, offset / length)
