"""Summary of a scale sweep, as text and as JSON."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from symjax.l2e.fit import Fit
from symjax.scale_sweep.optima import NOT_CONVERGED
from symjax.scale_sweep.run import ScaleSweep

HEADER = f"{'sigma':>9}  {'normal':^29}  {'offset':>12}  {'loss':>12}  {'converged':>9}  {'optima':>6}  {'inliers':>7}"


def lines(sweep: ScaleSweep) -> Iterator[str]:
    """Yields the summary: a table with the best plane at every σ, then the plane with estimated σ."""
    pairs, options = sweep.pairs, sweep.options
    for note in pairs.notes:
        yield f"{'pairs':<10}{note}"
    number = sweep.rank.shape[1]
    starts = f"{number} {'start' if number == 1 else 'starts'} each ({options.start}), solver {options.solver}"
    followed = "; every sigma starts from the optima of the next larger one" if options.continuation else ""
    yield f"{'sweep':<10}{len(sweep.fractions)} values of sigma, {starts}{followed}"
    yield f"{'units':<10}sigma as a fraction of the diagonal ({pairs.diagonal:.6g}), offset in the units of the points"
    yield ""
    yield HEADER
    for row in rows(sweep):
        normal = " ".join(f"{_shown(component, '+.6f'):>9}" for component in row["normal"])
        offset, loss = (f"{_shown(row[name], sign):>12}" for name, sign in (("offset", "+.6g"), ("loss", ".6g")))
        inliers = f"{_shown(row['inlier_fraction'], '.1%'):>7}"
        yield f"{row['sigma']:9.5f}  {normal}  {offset}  {loss}  {row['converged']:9.1%}  {row['optima']:6d}  {inliers}"
    yield ""
    found = sweep.estimated
    sigma = float(found.sigma)
    normal = "  ".join(f"{component:+.6f}" for component in found.plane.normal)
    yield f"{'estimated':<10}sigma {sigma / pairs.diagonal:.5f} of the diagonal, {sigma:.4g} in the units of the points"
    yield f"{'':<10}normal {normal}, offset {float(found.plane.offset):+.6g}"
    yield f"{'':<10}{float(found.inlier_fraction):.1%} of the pairs are inliers   ({found.message})"


def rows(sweep: ScaleSweep) -> Iterator[dict[str, Any]]:
    """Yields for every σ the best plane, the fraction of starts that converged, and the number of optima.

    Numbers that are not finite become None.
    """
    for index, fraction in enumerate(sweep.fractions):
        rank = sweep.rank[index]
        yield {
            "sigma": float(fraction),
            **_values(sweep.best, index),
            "converged": float(np.mean(rank != NOT_CONVERGED)),
            "optima": int(rank.max()) + 1,
        }


def as_dict(sweep: ScaleSweep) -> dict[str, Any]:
    """Returns the scale sweep as values that JSON can represent, with σ as fractions of the diagonal."""
    return {
        "num_pairs": len(sweep.pairs.x),
        "notes": list(sweep.pairs.notes),
        "diagonal": sweep.pairs.diagonal,
        **sweep.options._asdict(),
        "sweep": list(rows(sweep)),
        "estimated": {
            "sigma": _finite(sweep.estimated.sigma / sweep.pairs.diagonal),
            **_values(sweep.estimated, ()),
            "converged": bool(sweep.estimated.converged),
        },
    }


def _values(fit: Fit, index: int | tuple[()]) -> dict[str, Any]:
    return {
        "normal": [_finite(component) for component in fit.plane.normal[index]],
        "offset": _finite(fit.plane.offset[index]),
        "loss": _finite(fit.loss[index]),
        "inlier_fraction": _finite(fit.inlier_fraction[index]),
    }


def _finite(value: Any) -> float | None:
    return float(value) if math.isfinite(value) else None


def _shown(value: float | None, spec: str) -> str:
    return "-" if value is None else format(value, spec)
