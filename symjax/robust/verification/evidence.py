"""Evidence: which candidate comes first, and which others the cloud confirms beside it.

A cloud is complete if a good plane maps all of it onto itself. Then nothing is missing, and no other plane is excused
by a missing part. If the cloud is not complete, a further plane must agree with the cloud that the first plane
completes.
"""

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

from symjax.geometry.plane import Plane
from symjax.robust.surface import Surface
from symjax.robust.verification.contradiction import Completion, Contradiction

Verdict = Literal["confirmed", "unconfirmed", "ruled out", "refuted"]
"""An unconfirmed plane may be a mirror plane, but too much of the object is missing to tell. A plane is ruled out if it
needs a missing part although the cloud is complete. It is refuted if no missing part could explain its
contradiction."""

REFUTING, REFUTING_ONE_SIDED = 0.03, 0.05
"""Refuting contradiction above which a plane is refuted. Measured on 52 man-made objects, whole, noisy, cut, and with
outliers: at most 0.004 for exact mirror planes, and 0.02 to 0.1 for the best planes of objects without one; on scans
from one side 0.03 for exact mirror planes. A real fish whose fins are not alike has 0.03 to 0.1."""

COMPLETE = 0.005
"""Gross contradiction below which a plane maps the whole cloud onto itself. Measured with the right plane: at most
0.0024 on whole objects."""

SAME_RANK = 0.99
"""Fraction of the best ranking score above which a plane that maps the whole cloud onto itself comes first. If it ranks
lower, then the object may be cut symmetrically about a plane that is nearly a mirror plane."""

AT_CUT = 0.5
"""Fraction of boundary points beside the far mirror images of a plane above which the cloud may be cut rather than
complete. Measured: 0.35 for the handle near the rim of a saucepan, 0.8 to 1 at cuts."""

CONFIRMED = 0.01
"""Gross contradiction below which a complete cloud confirms a further plane."""

CONFIRMED_BY_COMPLETION, CONFIRMED_BY_COMPLETED_VIEW = 0.1, 0.02
"""Gross contradiction of the completed cloud below which an incomplete cloud, or a scan from one side, confirms a
further plane. More is excused on a cut cloud: the plane that completes it does not fill a hole that it cuts in two."""


def best_first(
    ranking_scores: Sequence[float], contradictions: Sequence[Contradiction], *, one_sided: bool
) -> tuple[list[int], bool]:
    """Orders refined candidates.

    Args:
        ranking_scores: ranking score of every candidate.
        contradictions: contradiction of every candidate.
        one_sided: whether the cloud is a scan from one side.

    Returns:
        The order, the best first and refuted candidates last; and whether the cloud is complete.
    """
    order = sorted(
        range(len(ranking_scores)),
        key=lambda i: (is_refuted(contradictions[i], one_sided=one_sided), -ranking_scores[i]),
    )
    best = ranking_scores[order[0]]
    for i in order:
        if contradictions[i].gross < COMPLETE and ranking_scores[i] >= SAME_RANK * best:
            order.remove(i)
            return [i, *order], True
    return order, False


def is_refuted(contradiction: Contradiction, *, one_sided: bool) -> bool:
    """Returns whether the cloud refutes a plane."""
    return contradiction.refuting > (REFUTING_ONE_SIDED if one_sided else REFUTING)


class Evidence(NamedTuple):
    """What the cloud says about the refined candidates at a coarse scale.

    Attributes:
        surface: the surface, in units of its diagonal.
        one_sided: whether the cloud is a scan from one side.
        complete: whether the best plane maps the whole cloud onto itself.
        planes: the refined candidates, the best first.
        contradictions: contradiction of each.
    """

    surface: Surface
    one_sided: bool
    complete: bool
    planes: tuple[Plane, ...]
    contradictions: tuple[Contradiction, ...]

    def verdicts(self, ranks: Iterable[int]) -> dict[int, Verdict]:
        """Decides about candidates: whether the cloud confirms them beside the best one.

        Every plane that is confirmed completes the cloud for the next one.

        Args:
            ranks: ranks of the candidates, from 0 and ascending.
        """
        found: dict[int, Verdict] = {}
        completion = Completion(self.surface, self.surface.points, self.surface.confidence).add(self.planes[0])
        limit = CONFIRMED_BY_COMPLETED_VIEW if self.one_sided else CONFIRMED_BY_COMPLETION
        for rank in ranks:
            found[rank] = self._verdict(rank)
            # a complete cloud has no missing part that a completion could fill
            if found[rank] != "unconfirmed" or self.complete or rank >= len(self.planes):
                continue
            if completion.contradiction(self.planes[rank]) < limit:
                found[rank] = "confirmed"
                completion = completion.add(self.planes[rank])
        return found

    def _verdict(self, rank: int) -> Verdict:
        """Decides about a candidate by its contradiction alone."""
        if rank >= len(self.planes):  # not refined, too inexact to tell
            return "unconfirmed"
        contradiction = self.contradictions[rank]
        if is_refuted(contradiction, one_sided=self.one_sided):
            return "refuted"
        if rank == 0 or (self.complete and contradiction.gross < CONFIRMED):
            return "confirmed"
        return "ruled out" if self.complete and contradiction.at_boundary <= AT_CUT else "unconfirmed"
