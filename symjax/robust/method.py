"""Method: `Robust`, which runs the stages of the robust method and holds its options."""

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from symjax.errors import InvalidArgumentError
from symjax.geometry import checks
from symjax.geometry.plane import Plane
from symjax.method.result import Candidate, MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud
from symjax.robust.duplicates import are_duplicates
from symjax.robust.initial_plane import checked_plane
from symjax.robust.quadrics import Quadrics, fit_quadrics
from symjax.robust.sheet import FLAT_THRESHOLDS, OWN_PLANE, find_sheet, uncertainty_in_space, upright
from symjax.robust.surface import Surface, estimate_surface
from symjax.robust.verification.classification import classify
from symjax.robust.verification.contradiction import NO_CONTRADICTION, Contradiction, contradiction
from symjax.robust.verification.evidence import Evidence, best_first
from symjax.robust.verification.layers import doubt_of_layers, with_layers
from symjax.robust.verification.notes import notes
from symjax.robust.verification.scoring import PlaneScore, exactness, score_plane
from symjax.robust.verification.thresholds import FoundThresholds
from symjax.robust.visibility import find_viewpoint
from symjax.robust.voxel_grid import VoxelGrid, voxel_grid

if TYPE_CHECKING:
    from symjax.robust.refinement import Refinement


@dataclass(frozen=True, kw_only=True)
class Robust:
    """The robust method: hypotheses are registered, refined by L2E, and scored against the cloud.

    Correspondences are not fixed in advance: they are found anew as the plane moves. What a scan could not see hardly
    counts against a plane. The method therefore copes with noise, outliers, missing parts and scans from one side. The
    package `symjax.robust` documents its stages.

    The defaults are the method. Each option switches off a stage or changes a number, for ablations and calibrations.

    Attributes:
        init: an additional hypothesis, in the units of the input points; None for none. A wrong one does no harm.
        use_point_confidence: whether points weigh less if they do not fit their neighbours' tangent planes. Such points
            are outliers or lie on edges. Otherwise all points weigh the same.
        use_visibility: whether to recognise a scan from one side. Mirror images in space that such a scan could not see
            hardly count against a plane. For all other clouds, only `boundary_penalty` excuses missing parts.
        boundary_penalty: non-match penalty of mirror images beyond the boundary of the surface, 0 to 1. Inside the
            surface it is 1. A low value means that a part that was not scanned counts little against a plane.
        use_normals: whether mirror images must agree with the surface in normal direction too, in the registration and
            in the scores. The nearest point on an unrelated surface, or across a thin part, has a different normal.
        num_pair_hypotheses: maximum number of hypotheses from pairs of points; 0 for none. On 36 generated clouds
            (whole, noisy, or cut with outliers) at least 1 of 1024, and 17 in the median, lay within 8° and 0.03
            diagonals of the true plane. From there the registration reaches it.
        register: whether to move hypotheses to the optimum of the L2E criterion before they are compared. The evenly
            spread hypotheses are 7° and 0.04 diagonals apart, too far to compare them as they are.
        exact_scoring: whether to order candidates by scores with exact nearest neighbours. Otherwise their scores come
            from the voxel grid, whose neighbours are wrong by up to the diagonal of a voxel.
        max_refined: maximum number of candidates that are refined. A cube has nine mirror planes.
        refine_above: fraction of the best refined candidate's score above which another candidate is refined too, since
            it may be another mirror plane.
        refine: whether a candidate takes the refined plane. Otherwise it keeps its own, and only the standard errors
            and σ come from the refinement.
        use_exactness: whether the exactness counts in the ranking and the classification. Otherwise it is not computed.
        exactness_weight: weight of the exactness in the ranking score, which is the score plus this weight times the
            exactness above `chance_exactness`. Exact agreement is rare by chance, and unlike the score it is not
            blurred by noise.
        chance_exactness: exactness that rough symmetries reach by chance, because a few parts agree exactly. Exactness
            below it is ignored.
        use_contradiction: whether mirror images far from the surface count as evidence of their own: they refute a
            plane if no missing part explains them, and further planes are only named if the cloud confirms them.
        use_layers: whether the layers on which a cloud is sampled enter the standard errors. A plane that they leave
            too uncertain is not found.
        inlier_agreement: agreement from which a pair counts as an inlier. The default is half of the maximum.
        found: the rule for the threshold that the score of a mirror plane must exceed.
        found_flat: the same rule for flat clouds, which are scored on their outlines.

    Raises:
        InvalidArgumentError: if an option has the wrong type or is out of range.

    Example:
        An ablation is the method with one option changed:

        >>> import dataclasses
        >>> import symjax
        >>> dataclasses.replace(symjax.Robust(), use_normals=False).use_normals
        False

        A stricter rule finds fewer planes:

        >>> strict = symjax.Robust(found=symjax.FoundThresholds(base=0.5))

        `symjax.detect` runs the method:

        >>> points = symjax.datasets.generate("quadruped", num_points=300, rng=0).points
        >>> detection = symjax.detect(points, strict)
        >>> print(detection.symmetry, abs(detection.plane.normal).round(2))
        one plane [1. 0. 0.]
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
    use_contradiction: bool = True
    use_layers: bool = True
    inlier_agreement: float = 0.5
    found: FoundThresholds = field(default_factory=FoundThresholds)
    found_flat: FoundThresholds = field(default_factory=lambda: FLAT_THRESHOLDS)

    def __post_init__(self) -> None:
        """Checks the options and normalises the initial plane."""
        if self.init is not None:
            object.__setattr__(self, "init", checked_plane(self.init))
        for name in ("boundary_penalty", "refine_above", "chance_exactness", "inlier_agreement"):
            checks.number(name, getattr(self, name), least=0, most=1)
        checks.number("exactness_weight", self.exactness_weight, least=0)
        checks.whole("num_pair_hypotheses", self.num_pair_hypotheses, 0)
        checks.whole("max_refined", self.max_refined, 1)
        for switch in fields(self):
            if isinstance(switch.default, bool):
                checks.flag(switch.name, getattr(self, switch.name))
        for name in ("found", "found_flat"):
            if not isinstance(getattr(self, name), FoundThresholds):
                raise InvalidArgumentError(
                    f"{name} must be a FoundThresholds, such as FoundThresholds(), got {getattr(self, name)!r}"
                )

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud.

        Args:
            cloud: distinct points in the cloud frame, in units of the diagonal, with normals if they are known.
            max_planes: not used, since `symjax.detect` shortens the list of candidates.
            rng: random generator, which draws pairs of points and the points that are reflected.
            timer: announces and times the stages.

        Returns:
            The candidates and their classification, in the frame and the units of the cloud.
        """
        # JAX is only imported when it is needed
        from symjax.robust.search import candidates

        init = None if self.init is None else cloud.to_given.inverse().plane(self.init)
        with timer.stage("surface"):
            sheet = find_sheet(cloud.points) if cloud.flat else None
            if sheet is None:
                whole = surface = estimate_surface(
                    cloud.points, normals=cloud.normals, use_confidence=self.use_point_confidence
                )
            else:
                whole, surface = sheet.whole, sheet.outline
                init = upright(init) if init is not None and abs(init.normal[2]) < OWN_PLANE else None
            viewpoint = find_viewpoint(surface) if self.use_visibility and sheet is None else None
            grid = voxel_grid(surface, viewpoint, boundary_penalty=self.boundary_penalty)
        with timer.stage("searching"):
            searched = candidates(
                surface,
                grid,
                rng,
                num_pairs=self.num_pair_hypotheses,
                init=init,
                flat=sheet is not None,
                register=self.register,
                exact_scoring=self.exact_scoring,
                use_normals=self.use_normals,
            )
        with timer.stage("refining"):
            quadrics = fit_quadrics(surface, size=None if sheet is None else sheet.patch_size)
            refined, others = self._refine(searched, surface, whole, quadrics, grid, one_sided=viewpoint is not None)
            order, complete = best_first(
                [r.candidate.ranking_score for r in refined],
                [r.contradiction for r in refined],
                one_sided=viewpoint is not None,
            )
            refined = [refined[i] for i in order]
        with timer.stage("classifying"):
            ranked = (*(r.candidate for r in refined), *others)
            evidence = Evidence(
                whole,
                viewpoint is not None,
                complete,
                tuple(r.candidate.plane for r in refined),
                tuple(r.contradiction for r in refined),
            )
            outline, thresholds = (None, self.found) if sheet is None else (surface, self.found_flat)
            result = classify(
                ranked, evidence, quadrics, grid, thresholds, outline=outline, use_normals=self.use_normals
            )
        best, scored = refined[0].refinement, refined[0].scored
        uncertainty, sentences = best.uncertainty, notes(evidence, result)
        if sheet is not None:
            uncertainty = uncertainty_in_space(uncertainty, best.plane, sheet)
            sentences = (sheet.note, *sentences)
        elif self.use_layers and cloud.layers is not None:
            weight = scored.weight * scored.agreement
            uncertainty = with_layers(uncertainty, ranked[0].plane, surface, weight, cloud.layers)
            doubt = doubt_of_layers(uncertainty, evidence, cloud.layers)
            if doubt is not None:
                result, sentences = result.none(), (*sentences, doubt)
        rows = np.flatnonzero(scored.weight > 0)
        agreement = scored.agreement[rows]
        return MethodResult(
            candidates=ranked,
            planes=result.planes,
            symmetry=result.symmetry,
            threshold=result.threshold,
            ambiguous=result.ambiguous,
            axis=result.axis,
            rows=np.stack([rows, scored.partner[rows]], axis=1),
            weight=agreement,
            inlier_weight=self.inlier_agreement,
            inlier_fraction=float(np.sum(agreement >= self.inlier_agreement) / max(len(rows), 1)),
            sigma=best.sigma,
            converged=best.converged,
            message=best.message,
            uncertainty=uncertainty,
            notes=sentences,
        )

    def _refine(
        self,
        searched: tuple[Candidate, ...],
        surface: Surface,
        whole: Surface,
        quadrics: Quadrics,
        grid: VoxelGrid,
        *,
        one_sided: bool,
    ) -> tuple[list["_Refined"], list[Candidate]]:
        """Refines the best candidates and scores them on all points; returns them, and the others ordered by score."""
        from symjax.robust.refinement import refine

        refined: list[_Refined] = []
        for candidate in searched:
            if len(refined) == self.max_refined:
                break
            if refined and candidate.score < self.refine_above * max(r.candidate.score for r in refined):
                break
            refinement = refine(candidate.plane, surface, quadrics)
            plane = refinement.plane if self.refine else candidate.plane
            if any(are_duplicates(plane, r.candidate.plane) for r in refined):
                continue
            scored = score_plane(plane, surface, grid, use_normals=self.use_normals)
            exact = exactness(plane, surface, scored, quadrics) if self.use_exactness else None
            score, ranking_score = scored.score, self._ranking_score(scored.score, exact)
            if whole is not surface:  # a flat cloud, whose outline decides the score
                scored = score_plane(plane, whole, grid, use_normals=self.use_normals)
            against = NO_CONTRADICTION
            if self.use_contradiction:
                against = contradiction(plane, whole, scored, one_sided=one_sided)
            refined.append(_Refined(Candidate(plane, score, ranking_score, exact), refinement, scored, against))
        others = [c for c in searched if not any(are_duplicates(c.plane, r.candidate.plane) for r in refined)]
        others.sort(key=lambda candidate: -candidate.score)
        return refined, others

    def _ranking_score(self, score: float, exact: float | None) -> float:
        """Returns the score plus the weighted exactness above chance."""
        return score + self.exactness_weight * max((exact or 0.0) - self.chance_exactness, 0.0)


class _Refined(NamedTuple):
    """A candidate with its refinement, its score on all points and its contradiction."""

    candidate: Candidate
    refinement: "Refinement"
    scored: PlaneScore
    contradiction: Contradiction
