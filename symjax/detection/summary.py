"""Text summary of a detection for a terminal."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jaxtyping import Float

    from symjax.detection.result import Detection
    from symjax.geometry.arrays import AnyArray


def lines(detection: "Detection") -> Iterator[str]:
    """Yields the summary, one label and value a line: the plane, its evidence, the points used and the time taken."""
    yield _line("normal", _components(detection.plane.normal))
    yield _line("offset", f"{float(detection.plane.offset):+.6g}   (normal · x = offset, in the units of the points)")
    uncertainty = detection.uncertainty
    if uncertainty is not None:
        precision = f"normal {uncertainty.normal_degrees:.2g} degrees, offset {uncertainty.offset:.2g}"
        yield _line("precision", f"{precision}   (standard errors)")
    yield _line("found", f"{'yes' if detection.found else 'no'}   ({_comparison(detection)})")
    if detection.found:
        yield _line("symmetry", _symmetry(detection))
    for rank, plane in enumerate(detection.planes[1:], 2):
        yield _line(f"plane {rank}", f"{_components(plane.normal)}   offset {float(plane.offset):+.6g}")
    if detection.exactness is not None:
        yield _line("exactness", f"{detection.exactness:.3f}   (0.5 to 1: exact symmetry; near 0: rough)")
    if detection.inlier_fraction is not None:
        yield _line("inliers", f"{detection.inlier_fraction:.1%} of {len(detection.pairs.weight)} pairs")
    yield _line("solver", detection.message or ("converged" if detection.converged else "not converged"))
    if detection.sigma is not None:
        in_units = detection.sigma * detection.diagonal
        yield _line("sigma", f"{detection.sigma:.4g} of the diagonal, {in_units:.4g} in the units of the points")
    yield _line("points", f"{detection.num_points} given, {detection.num_used} used")
    for note in detection.notes:
        yield _line("note", note)
    stages = ", ".join(f"{stage} {seconds:.2f}" for stage, seconds in detection.timings.items())
    yield _line("seconds", f"{sum(detection.timings.values()):.2f}   ({stages})")


def _comparison(detection: "Detection") -> str:
    """The score, compared with its threshold."""
    if detection.threshold is None:
        return f"score {detection.score:.3f}"
    relation = "above" if detection.score > detection.threshold else "not above"
    doubt = ", but refuted or not converged" if relation == "above" and not detection.found else ""
    return f"score {detection.score:.3f}, {relation} the threshold of {detection.threshold:.3f}{doubt}"


def _symmetry(detection: "Detection") -> str:
    if detection.axis is not None:
        point, direction = detection.axis
        if detection.symmetry == "sphere":
            return f"all planes through a centre   (at {_components(point)})"
        return f"all planes through an axis   (through {_components(point)} along {_components(direction)})"
    return f"{detection.symmetry}   (ambiguous: others are as good)" if detection.ambiguous else detection.symmetry


def _components(vector: "Float[AnyArray, ' 3']") -> str:
    return "  ".join(f"{component:+.6f}" for component in vector)


def _line(label: str, value: str) -> str:
    return f"{label:<10}{value}"
