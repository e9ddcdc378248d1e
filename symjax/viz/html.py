"""The interactive page of a detection: the cloud with its plane and pairs, and the completed object."""

import os
from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from symjax.viz import colours
from symjax.viz import scene as scenes
from symjax.viz.colours import css
from symjax.viz.drawable import Drawable
from symjax.viz.page import FONT, write_page
from symjax.viz.plotly_traces import coordinates, headlight, pairs_trace, plane_traces, points_trace

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


MAX_POINTS = 20_000
MAX_PAIRS = 1000
REMOVED_SCALE = 0.4
"""Size of the removed points, relative to the points of the surface."""

MAX_OTHERS = 4
"""Largest number of further candidate planes in the legend."""

DISTANT = 1e4
"""Distance from the origin, in sizes of the cloud, beyond which it is drawn about its centre: browsers use float32."""

FINE = 0.55
"""Size of the points in the left view, relative to points that cover the surface, so that the pairs are visible."""

ZOOM = 1.9
"""Longest extent of the initial view, in plotly's units. It sets the size of an orthographic view."""

LINK_VIEWS = """
const page = document.getElementById("{plot_id}");
let copying = false;
const copy = (change) => {
  if (copying) return;
  const same = {};
  for (const [from, to] of [["scene", "scene2"], ["scene2", "scene"]])
    for (const part of [".camera", ".aspectratio"])
      if (change[from + part]) same[to + part] = change[from + part];
  if (!Object.keys(same).length) return;
  copying = true;
  Plotly.relayout(page, same).finally(() => { copying = false; });
};
page.on("plotly_relayouting", copy);
page.on("plotly_relayout", copy);
"""
"""Applies every rotation and zoom of one view to the other. An orthographic view zooms by its aspect ratio."""


def write_html(
    detection: Drawable,
    path: str | os.PathLike[str],
    *,
    title: str = "symjax",
    max_points: int = MAX_POINTS,
    up: Sequence[float] | Float[np.ndarray, " 3"] | None = None,
) -> None:
    """Writes the interactive figure as one self-contained page of about 5 MB, which loads nothing from the network.

    Rotating one of the two views rotates the other.

    Args:
        detection: the detection to draw.
        path: file to write; an existing file is replaced.
        title: title of the page, as plain text.
        max_points: largest number of points to draw; a larger cloud is thinned.
        up: direction that points up in the initial view; by default, the cloud's longest direction within the plane.

    Raises:
        TooFewPointsError: if the detection has no points.
        InvalidArgumentError: if `max_points` is below 1, `up` is not a direction, or the file cannot be written.
    """
    write_page(
        figure(detection, max_points=max_points, up=up),
        path,
        title=title,
        notes=(f"Method: {detection.method}", *detection.notes),
        buttons=["toImage", "resetCameraDefault3d"],
        script=LINK_VIEWS,
    )


def figure(
    detection: Drawable, *, max_points: int = MAX_POINTS, up: Sequence[float] | Float[np.ndarray, " 3"] | None = None
) -> "Figure":
    """Makes a plotly figure with two views: the cloud with its plane and pairs, and the cloud with its mirror image.

    Inlier pairs are red, and their ends are redder for a higher weight; rejected pairs are faint and grey. The legend
    gives the number of pairs of both kinds. A click on an entry of the legend shows or hides a part, such as the plane
    of another candidate. A cloud very far from the origin is drawn about its centre, which the axis titles then give.

    Args:
        detection: the detection to draw.
        max_points: largest number of points to draw; a larger cloud is thinned.
        up: direction that points up; by default, the cloud's longest direction within the plane.

    Returns:
        The figure.

    Raises:
        TooFewPointsError: if the detection has no points.
        InvalidArgumentError: if `max_points` is below 1, or `up` is not a direction.
    """
    from plotly.graph_objects import Figure  # imported here because it takes a large part of a second

    scene = scenes.build(detection, max_points=max_points, max_pairs=MAX_PAIRS, up=up)
    is_distant = bool(np.abs(scene.origin).max() > DISTANT * scene.size)
    shift = np.zeros(3) if is_distant else scene.origin
    light = headlight(scene.cloud, scene.view.towards)
    traces = [
        points_trace(scene.cloud + shift, light, "cloud", colours.CLOUD, scene="scene", scale=FINE),
        points_trace(scene.cloud + shift, light, "cloud", colours.CLOUD, scene="scene2", showlegend=False),
        points_trace(scene.mirrored + shift, light, "mirror image", colours.MIRRORED, scene="scene2"),
        *plane_traces(scene.quad + shift, "mirror plane", colours.PLANE),
    ]
    if len(scene.removed):
        points, flat = scene.removed + shift, np.ones(len(scene.removed))
        traces.append(points_trace(points, flat, "removed points", colours.REMOVED, scene="scene", scale=REMOVED_SCALE))
    if scene.num_inliers:
        drawn = pairs_trace(
            scene, shift, scene.is_inlier, scene.num_inliers, "matched pairs", colours.PAIR, width=3, opacity=1.0
        )
        traces.append(drawn)
    if num_rejected := scene.num_pairs - scene.num_inliers:
        drawn = pairs_trace(
            scene, shift, ~scene.is_inlier, num_rejected, "rejected pairs", colours.REJECTED, width=1, opacity=0.4
        )
        traces.append(drawn)
    for rank, quad in enumerate(scene.others[:MAX_OTHERS], start=2):
        name = f"candidate {rank} (score {detection.candidates[rank - 1].score:.3f})"
        traces += plane_traces(quad + shift, name, colours.REJECTED, visible="legendonly")
    return Figure(data=traces, layout=_layout(detection, scene, shift))


def _layout(detection: Drawable, scene: scenes.Scene, shift: Float[np.ndarray, " 3"]) -> dict[str, Any]:
    """Returns the layout: headline, legend, and two views of the same box from the same direction, without grids."""
    equation, evidence = (escape(line) for line in scenes.headline(detection))
    low, high = scenes.bounds(scene, np.eye(3))
    low, high = low - 0.02 * scene.size, high + 0.02 * scene.size
    longest = np.ptp(scenes.bounds(scene, np.stack(scene.view[:2]).T), axis=0).max()
    space: dict[str, Any] = {
        "aspectmode": "manual",
        "aspectratio": coordinates(ZOOM * (high - low) / longest),
        "dragmode": "orbit",
        "camera": {
            "eye": coordinates(2 * scene.view.towards),
            "up": coordinates(scene.view.up),
            "projection": {"type": "orthographic"},
        },
    }
    for name, bottom, top, centre, is_shifted in zip(
        "xyz", low + shift, high + shift, scene.origin, scene.origin - shift, strict=True
    ):
        space[f"{name}axis"] = {
            "range": [bottom, top],
            "visible": bool(is_shifted),
            "title": {"text": f"{name} {'−' if centre > 0 else '+'} {abs(centre):.9g}"},
            "showgrid": False,
            "showbackground": False,
            "zeroline": False,
            "showticklabels": False,
            "showspikes": False,
        }
    faint = css(colours.FAINT_INK)
    return {
        "template": "none",
        "font": {"family": FONT, "size": 14, "color": faint},
        "title": {
            "text": f"{equation}<br><span style='font-size:15px;color:{faint}'>{evidence}</span>",
            "font": {"size": 22, "color": css(colours.INK)},
            "x": 0.0,
            "xref": "container",
            "pad": {"l": 24},
        },
        "margin": {"l": 0, "r": 0, "t": 84, "b": 0},
        "legend": {"orientation": "h", "x": 0.01, "y": 0.0, "yanchor": "bottom", "itemsizing": "constant"},
        "scene": {**space, "domain": {"x": [0.0, 0.5], "y": [0.06, 1.0]}},
        "scene2": {**space, "domain": {"x": [0.5, 1.0], "y": [0.06, 1.0]}},
    }
