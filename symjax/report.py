"""What a person reads about a detection on a terminal."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symjax.detection import Detection


def lines(detection: "Detection") -> Iterator[str]:
    """The plane, how far to trust it, and what it cost, one label and value a line."""
    yield _line("normal", "  ".join(f"{component:+.6f}" for component in detection.plane.normal))
    yield _line("offset", f"{float(detection.plane.offset):+.6g}   (normal · x = offset, in the units of the points)")
    verdict, relation = ("yes", "above") if detection.found else ("no", "not above")
    if not detection.found and detection.score > detection.threshold:
        relation = "above"
    yield _line(
        "found", f"{verdict}   (score {detection.score:.3f}, {relation} the threshold {detection.threshold:.3f})"
    )
    yield _line("inliers", f"{detection.inlier_fraction:.1%} of {len(detection.pairs.weight)} pairs")
    yield _line("converged", f"{'yes' if detection.converged else 'no'}   ({detection.message})")
    yield _line("sigma", f"{detection.sigma:g} of the diagonal, {detection.sigma * detection.diagonal:.4g} in units")
    yield _line("points", f"{detection.num_points} given, {detection.num_used} used")
    for note in detection.notes:
        yield _line("note", note)
    stages = "   ".join(f"{stage} {seconds:.2f}" for stage, seconds in detection.timings.items())
    yield _line("seconds", f"{sum(detection.timings.values()):.2f}   ({stages})")


def _line(label: str, value: str) -> str:
    return f"{label:<10}{value}"
