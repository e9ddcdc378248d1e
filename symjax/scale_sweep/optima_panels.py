"""The optima of a scale sweep against σ: how far from the estimated plane, and how good."""

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
"""Where the logarithmic axes end, in degrees and in per cent of the diagonal: nearer planes are drawn there."""

NAMES = (
    "angle to the plane with σ estimated",
    "distance from it, of the diagonal",
    "loss, in units of (4πσ²)<sup>−3/2</sup>",
)
WIDTH, GAP = 0.44, 0.085
"""Where the panels end, and the gap between them, in widths and heights of the page."""

HEIGHT = (1 - 2 * GAP) / 3

ANGLES = {value: f"{value:g}°" for value in (0.001, 0.01, 0.1, 1, 10, 90)}
DISTANCES = {value: f"{value:g} %" for value in (0.001, 0.01, 0.1, 1, 10, 100)}
SIGMAS = {value * 10.0**power: f"{value * 10.0**power:g}" for power in range(-6, 3) for value in (1, 2, 5)}
"""Ticks."""


def traces(sweep: "ScaleSweep", found: list[list[Optimum]]) -> list[dict[str, Any]]:
    """For each panel a line through the best plane of every σ, and a dot for every optimum.

    A dot has the colour of its rank, as on the sphere map, and is the larger the more starts reach it.

    Args:
        sweep: what is drawn.
        found: the distinct optima at every σ.
    """
    # the best last, so that it is drawn above the others
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
        "size": [4 + 8 * float(np.sqrt(optimum.share)) for _, _, optimum in dots],
        "line": {"width": 0.5, "color": "white"},
        "opacity": 0.9,
    }
    labels = [
        f"σ {sweep.fractions[index]:.4g}, optimum {rank + 1} of {len(found[index])}<br>"
        f"{optimum.share:.1%} of the starts, loss {optimum.loss:.6g}"
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
    """Of planes, what the three panels show."""
    truth, pairs = sweep.estimated.plane, sweep.pairs
    angle = np.asarray(deviation_angle(planes.normal, truth.normal))
    distance = np.asarray(offset_error(planes, truth, pairs.centre, pairs.diagonal))
    unit = (4 * np.pi * (fractions * pairs.diagonal) ** 2) ** 1.5
    return [np.maximum(angle, LEAST), np.maximum(100 * distance, LEAST), loss * unit]


def axes() -> dict[str, Any]:
    """The layout's axes of the three panels, over one another."""
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
    """The upper edge of a panel, counted from 1 at the top."""
    return (3 - number) * (HEIGHT + GAP) + HEIGHT


def _ticks(names: dict[float, str]) -> dict[str, Any]:
    return {"tickvals": list(names), "ticktext": list(names.values())}
