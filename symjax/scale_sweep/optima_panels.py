"""Plots of the optima of a scale sweep against σ: angle and distance to the estimated plane, and loss."""

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from symjax.geometry.directions import deviation_angle
from symjax.geometry.distance import offset_error
from symjax.scale_sweep.optima import Optimum
from symjax.scale_sweep.sphere_map import COLOURS, colour_index
from symjax.viz import colours
from symjax.viz.colours import css

if TYPE_CHECKING:
    from symjax.geometry.plane import Plane
    from symjax.scale_sweep.run import ScaleSweep

LEAST = 1e-3
"""Lower limit of the logarithmic axes, in degrees and in per cent of the diagonal. Smaller values are drawn there."""

NAMES = (
    "angle to the plane with estimated σ",
    "distance to that plane, of the diagonal",
    "loss, in units of (4πσ²)<sup>−3/2</sup>",
)
WIDTH, GAP = 0.44, 0.085
"""Right edge of the panels as a fraction of the page's width, and the gap between them as one of its height."""

HEIGHT = (1 - 2 * GAP) / 3

ANGLES = {value: f"{value:g}°" for value in (0.001, 0.01, 0.1, 1, 10, 90)}
DISTANCES = {value: f"{value:g} %" for value in (0.001, 0.01, 0.1, 1, 10, 100)}
SIGMAS = {value * 10.0**power: f"{value * 10.0**power:g}" for power in range(-6, 3) for value in (1, 2, 5)}
"""Ticks of the axes: values and their labels."""


def traces(sweep: "ScaleSweep", found: list[list[Optimum]]) -> list[dict[str, Any]]:
    """Returns two plotly traces per panel: a line through the best plane at every σ, and a dot for every optimum.

    The colour of a dot shows its rank, as on the sphere map. Its size shows how many starts reach the optimum.

    Args:
        sweep: the scale sweep.
        found: the distinct optima at every σ.
    """
    # the best is last, so that it is drawn above the others
    dots = [
        (index, rank, optimum) for index, row in enumerate(found) for rank, optimum in reversed(list(enumerate(row)))
    ]
    fractions = sweep.fractions[[index for index, _, _ in dots]]
    planes = sweep.best.plane._replace(
        normal=np.reshape([optimum.plane.normal for _, _, optimum in dots], (-1, 3)),
        offset=np.array([optimum.plane.offset for _, _, optimum in dots]),
    )
    loss = np.array([optimum.loss for _, _, optimum in dots])
    marker = {
        "color": [css(COLOURS[index]) for index in colour_index(np.array([rank for _, rank, _ in dots], int))],
        "size": [4 + 8 * float(np.sqrt(optimum.fraction)) for _, _, optimum in dots],
        "line": {"width": 0.5, "color": "white"},
        "opacity": 0.9,
    }
    labels = [
        f"σ {sweep.fractions[index]:.4g}, optimum {rank + 1} of {len(found[index])}<br>"
        f"{optimum.fraction:.1%} of the starts, loss {optimum.loss:.6g}"
        for index, rank, optimum in dots
    ]
    lines = _heights(sweep, sweep.best.plane, np.asarray(sweep.best.loss), sweep.fractions)
    drawn: list[dict[str, Any]] = []
    for number, heights in enumerate(zip(lines, _heights(sweep, planes, loss, fractions), strict=True), start=1):
        line, dot = ({"type": "scatter", "xaxis": f"x{number}", "yaxis": f"y{number}", "y": y} for y in heights)
        stroke = {"color": css(COLOURS[0]), "width": 2}
        drawn += [
            {**line, "mode": "lines", "x": sweep.fractions, "line": stroke, "hoverinfo": "skip"},
            {**dot, "mode": "markers", "x": fractions, "marker": marker, "text": labels, "hovertemplate": _HOVER},
        ]
    return [{**trace, "showlegend": False} for trace in drawn]


_HOVER = "%{text}<br>%{y:.4g}<extra></extra>"


def _heights(
    sweep: "ScaleSweep", planes: "Plane", loss: Float[np.ndarray, " k"], fractions: Float[np.ndarray, " k"]
) -> list[Float[np.ndarray, " k"]]:
    """Computes the values that the three panels show of some planes."""
    reference, pairs = sweep.estimated.plane, sweep.pairs
    angle = np.asarray(deviation_angle(planes.normal, reference.normal))
    distance = np.asarray(offset_error(planes, reference, pairs.centre, pairs.diagonal))
    unit = (4 * np.pi * (fractions * pairs.diagonal) ** 2) ** 1.5
    return [np.maximum(angle, LEAST), np.maximum(100 * distance, LEAST), loss * unit]


def axes() -> dict[str, Any]:
    """Returns the axes of plotly's layout for the three panels, which are stacked."""
    shared = {
        "gridcolor": "rgb(236, 239, 243)",
        "linecolor": css(colours.REJECTED),
        "zeroline": False,
        "ticks": "outside",
        "tickcolor": css(colours.REJECTED),
        "tickfont": {"size": 12},
        "title": {"font": {"size": 13}},
    }
    layout: dict[str, Any] = {}
    for number, ticks in enumerate((ANGLES, DISTANCES, None), start=1):
        across = {"type": "log", "domain": [0.0, WIDTH], "anchor": f"y{number}", "showline": True, **_ticks(SIGMAS)}
        if number > 1:
            across["matches"] = "x"
        kind = {"type": "linear"} if ticks is None else {"type": "log", **_ticks(ticks)}
        layout[f"xaxis{number}"] = {**shared, **across, "showticklabels": number == 3}
        layout[f"yaxis{number}"] = {
            **shared,
            **kind,
            "domain": [top(number) - HEIGHT, top(number)],
            "anchor": f"x{number}",
        }
    layout["xaxis3"]["title"] = {"text": "σ, as a fraction of the diagonal", "font": {"size": 13}}
    return layout


def top(number: int) -> float:
    """Returns the upper edge of a panel; panels are numbered from 1 at the top."""
    return (3 - number) * (HEIGHT + GAP) + HEIGHT


def _ticks(names: dict[float, str]) -> dict[str, Any]:
    return {"tickvals": list(names), "ticktext": list(names.values())}
