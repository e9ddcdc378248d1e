"""Interactive page of a scale sweep: plots of the optima against σ, and the basin map."""

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from symjax.scale_sweep import optima_panels
from symjax.scale_sweep.optima import Optimum, optima
from symjax.scale_sweep.sphere_map import SphereMap, view
from symjax.viz import colours
from symjax.viz.colours import css
from symjax.viz.page import FONT, write_page

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from symjax.scale_sweep.run import ScaleSweep

SPHERE, SPHERE_END = 0.49, 0.9
"""Left and right edge of the sphere map as fractions of the page's width; the legend is to its right."""

BASINS = (
    "A point of the sphere is the normal of a plane. Opposite points are the same plane, so that half of the sphere "
    "shows every plane. Dots are starts and diamonds are optima. A start and the region around it have the colour of "
    "the optimum that the start reaches"
)
NO_BASINS = "A continuation follows optima from one σ to the next: the sphere shows optima (diamonds) but no basins"


def write_html(sweep: "ScaleSweep", path: str | os.PathLike[str], *, title: str = "symjax sweep") -> None:
    """Writes the figure as one self-contained HTML page of about 5 MB, which loads nothing from the network.

    Args:
        sweep: the result of `symjax.scale_sweep.run.scale_sweep`.
        path: the file to write; an existing file is replaced.
        title: title of the page, as plain text.

    Raises:
        InvalidArgumentError: if the file cannot be written.
    """
    notes = (*sweep.pairs.notes, NO_BASINS if sweep.fits.start is None else BASINS)
    write_page(figure(sweep), path, title=title, notes=notes)


def figure(sweep: "ScaleSweep") -> "Figure":
    """Returns a plotly figure: three panels against σ on the left, the basin map with a slider for σ on the right.

    The slider begins at the σ nearest to the estimated one. A band in the panels marks the σ of the slider.
    """
    from plotly.graph_objects import Figure  # plotly is slow to import: only for those who draw

    found = [
        optima(sweep.fits.plane._replace(normal=normal, offset=offset), loss, rank)
        for normal, offset, loss, rank in zip(*sweep.fits.plane, sweep.fits.loss, sweep.rank, strict=True)
    ]
    sphere = SphereMap(sweep, found)
    first = int(np.argmin(np.abs(np.log(sweep.fractions / _estimated(sweep)))))
    still = [*optima_panels.traces(sweep, found), *sphere.fixed()]
    frames = [
        {
            "name": str(index),
            "data": sphere.changes(index),
            "traces": list(range(len(still), len(still) + 3)),
            "layout": {"shapes": _lines(sweep, fraction)},
        }
        for index, fraction in enumerate(sweep.fractions)
    ]
    return Figure(data=[*still, *sphere.at(first)], layout=_layout(sweep, found, first), frames=frames)


def _estimated(sweep: "ScaleSweep") -> float:
    """The estimated σ as a fraction of the diagonal."""
    return float(sweep.estimated.sigma) / sweep.pairs.diagonal


def _lines(sweep: "ScaleSweep", fraction: float) -> list[dict[str, Any]]:
    """Returns vertical lines through all panels: a band at the σ of the sphere map, dots at the estimated σ."""
    styles = ((fraction, colours.REMOVED, 7, "solid"), (_estimated(sweep), colours.INK, 1, "dot"))
    return [
        {
            "type": "line",
            **{"x0": at, "x1": at, "xref": "x", "y0": 0, "y1": 1, "yref": "paper"},
            "line": {"color": css(colour), "width": width, "dash": dash},
            "layer": "below",
        }
        for at, colour, width, dash in styles
    ]


def _layout(sweep: "ScaleSweep", found: list[list[Optimum]], first: int) -> dict[str, Any]:
    faint = css(colours.FAINT_INK)
    options, plane = sweep.options, sweep.estimated.plane
    number = sweep.rank.shape[1]
    normal = ", ".join(f"{component:z.4f}" for component in plane.normal)
    subtitle = (
        f"Estimated σ: {_estimated(sweep):.4g} of the diagonal; {float(sweep.estimated.inlier_fraction):.0%} of "
        f"{len(sweep.pairs.x)} pairs are inliers. {number} {'start' if number == 1 else 'starts'} "
        f"({options.start}) at each of {len(found)} σ, solver {options.solver}"
    )
    headings = [(name, 0.0, optima_panels.top(number)) for number, name in enumerate(optima_panels.NAMES, start=1)]
    return {
        "template": "none",
        "font": {"family": FONT, "size": 13, "color": faint},
        "title": {
            "text": f"Mirror plane ({normal}) · x = {float(plane.offset):z.6g}"
            f"<br><span style='font-size:15px;color:{faint}'>{subtitle}</span>",
            "font": {"size": 22, "color": css(colours.INK)},
            "x": 0.0,
            "xref": "container",
            "pad": {"l": 24},
        },
        "margin": {"l": 70, "r": 24, "t": 124, "b": 54},
        "legend": {
            **{"x": 1.0, "xanchor": "right", "y": 1.02, "yanchor": "top"},
            "itemsizing": "constant",
            "bgcolor": "rgba(255, 255, 255, 0.6)",
        },
        "hovermode": "closest",
        "scene": {**view(np.asarray(plane.normal)), "domain": {"x": [SPHERE, SPHERE_END], "y": [0.1, 1.0]}},
        "sliders": [_slider(sweep, found, first)],
        "shapes": _lines(sweep, sweep.fractions[first]),
        "annotations": [_heading(*heading) for heading in (*headings, ("where the starts end", SPHERE + 0.03, 1.0))],
        **optima_panels.axes(),
    }


def _heading(text: str, x: float, y: float) -> dict[str, Any]:
    return {
        "text": text,
        **{"x": x, "xref": "paper", "xanchor": "left", "y": y, "yref": "paper", "yanchor": "bottom"},
        "yshift": 4,
        "showarrow": False,
        "font": {"size": 14, "color": css(colours.INK)},
    }


def _slider(sweep: "ScaleSweep", found: list[list[Optimum]], first: int) -> dict[str, Any]:
    """Returns the slider, with one step for every σ."""
    at_once = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    converged = np.asarray(sweep.fits.converged).mean(axis=1)
    return {
        "active": first,
        "steps": [
            {
                "label": f"{fraction:.4g} of the diagonal: {len(row)} {'optimum' if len(row) == 1 else 'optima'}, "
                f"{converged[index]:.0%} of the starts converged",
                "method": "animate",
                "args": [[str(index)], at_once],
            }
            for index, (fraction, row) in enumerate(zip(sweep.fractions, found, strict=True))
        ],
        "currentvalue": {"prefix": "σ ", "font": {"size": 15, "color": css(colours.INK)}, "xanchor": "left"},
        # the labels are long: only the current one is shown
        "font": {"color": "rgba(0, 0, 0, 0)"},
        "x": SPHERE + 0.03,
        "len": 0.97 - SPHERE,
        "y": 0.1,
    }
