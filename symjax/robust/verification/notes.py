"""Notes: what the method assumed about a cloud, and what could change the answer, as sentences."""

from symjax.robust.verification.classification import Classification
from symjax.robust.verification.evidence import Evidence

ONE_SIDED = "the cloud is a scan from one side: mirror images in hidden space hardly count against a plane"


def notes(evidence: Evidence, result: Classification) -> tuple[str, ...]:
    """Writes the notes of a result.

    Args:
        evidence: the coarse evidence about the candidates.
        result: the classification of the candidates.

    Returns:
        Sentences without a full stop; none if there is nothing to doubt.
    """
    found: list[str] = []
    if evidence.one_sided:
        found.append(ONE_SIDED)
    best = evidence.contradictions[0]
    if result.refuted:
        found.append(
            f"the best plane is no mirror plane: it maps {best.refuting:.1%} of the cloud to places where the object "
            "has no surface, and no missing part explains that"
        )
    elif best.gross > best.refuting and result.symmetry != "none" and not evidence.complete:
        found.append(
            f"{best.gross:.0%} of the cloud has no counterpart under the best plane: that part is taken to be missing"
        )
    if result.unconfirmed:
        others = "another plane agrees" if result.unconfirmed == 1 else f"{result.unconfirmed} other planes agree"
        found.append(
            f"{others} nearly as well, but too much of the object is missing to confirm it: see the candidates"
        )
    return tuple(found)
