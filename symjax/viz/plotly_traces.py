"""Points, planes and pairs as plotly traces, which are plain dictionaries."""

from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import cKDTree

from symjax.geometry.local_frames import local_frames
from symjax.viz.colours import PAIR, REJECTED, Rgb, css
from symjax.viz.scene import Scene

LIGHTING_NEIGHBOURS = 16
"""Number of neighbours from which the normal of a point is estimated for the lighting."""

DARKEST = 0.45
"""Brightness of a point whose surface is seen edge-on."""


def headlight(points: Float[np.ndarray, "n 3"], towards: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " n"]:
    """Computes the light on each point from a lamp at the viewer, 0 to 1. The sign of the normals does not matter."""
    if len(points) < LIGHTING_NEIGHBOURS:
        return np.ones(len(points))
    neighbours = cKDTree(points).query(points, LIGHTING_NEIGHBOURS)[1]
    normals = local_frames(points, neighbours)[1][:, :, 0]
    light: Float[np.ndarray, " n"] = np.abs(normals @ towards)
    return light


def points_trace(
    points: Float[np.ndarray, "n 3"],
    light: Float[np.ndarray, " n"],
    name: str,
    colour: Rgb,
    *,
    scale: float = 1.0,
    **options: Any,
) -> dict[str, Any]:
    """Makes a trace of lit points that cover the surface. The brightest is first: the legend shows the first colour."""
    order = np.argsort(-light, kind="stable")
    return {
        "type": "scatter3d",
        "mode": "markers",
        "name": name,
        "legendgroup": name,
        **_columns(points[order].astype(np.float32)),
        "marker": {
            "size": scale * float(np.clip(280 / np.sqrt(len(points)), 2.2, 8.0)),
            "color": light[order].astype(np.float32),
            "colorscale": [[0, css(colour, DARKEST)], [1, css(colour)]],
            "cmin": 0,
            "cmax": 1,
            "line": {"width": 0},
        },
        "hovertemplate": "%{x:.5g}, %{y:.5g}, %{z:.5g}<extra></extra>",
        **options,
    }


def plane_traces(quad: Float[np.ndarray, "4 3"], name: str, colour: Rgb, **options: Any) -> list[dict[str, Any]]:
    """Makes two traces, a translucent quad and its edge, with one legend entry."""
    shared = {"name": name, "legendgroup": name, "hoverinfo": "skip", "scene": "scene", **options}
    face = {
        "type": "mesh3d",
        **_columns(quad),
        "i": [0, 0],
        "j": [1, 2],
        "k": [2, 3],
        "color": css(colour),
        "opacity": 0.3,
        "lighting": {"ambient": 1.0, "diffuse": 0.0, "specular": 0.0},
        "showlegend": True,
    }
    edge = {
        "type": "scatter3d",
        "mode": "lines",
        **_columns(quad[[0, 1, 2, 3, 0]]),
        "line": {"color": css(colour), "width": 4},
        "showlegend": False,
    }
    return [{**face, **shared}, {**edge, **shared}]


def pairs_trace(
    scene: Scene,
    shift: Float[np.ndarray, " 3"],
    chosen: Bool[np.ndarray, " m"],
    total: int,
    name: str,
    colour: Rgb,
    *,
    width: float,
    opacity: float,
) -> dict[str, Any]:
    """Makes one trace of the chosen pairs: segments separated by gaps, with ends coloured by weight.

    Args:
        scene: the scene whose pairs are drawn.
        shift: vector added to all coordinates.
        chosen: mask of the pairs to draw.
        total: number of pairs of this kind, drawn or not, for the legend.
        name: name in the legend.
        colour: colour of the segments.
        width: width of the segments.
        opacity: opacity of the segments and their ends.

    Returns:
        The trace.
    """
    gap = np.full((int(chosen.sum()), 3), np.nan)
    ends = np.stack([scene.x[chosen] + shift, scene.y[chosen] + shift, gap], axis=1).reshape(-1, 3)
    weight = np.repeat(scene.weight[chosen], 3)
    return {
        "type": "scatter3d",
        "mode": "lines+markers",
        "name": f"{name} ({total})" if total == len(gap) else f"{name} ({total}, {len(gap)} drawn)",
        "scene": "scene",
        **_columns(ends),
        "line": {"color": css(colour), "width": width},
        "marker": {
            "size": 1 + width,
            "color": weight,
            "colorscale": [[0, css(REJECTED)], [1, css(PAIR)]],
            "cmin": 0,
            "cmax": 1,
            "line": {"width": 0},
        },
        "opacity": opacity,
        "customdata": weight,
        "hovertemplate": "weight %{customdata:.3f}<extra></extra>",
    }


def _columns(points: Float[np.ndarray, "n 3"]) -> dict[str, Float[np.ndarray, " n"]]:
    return dict(zip("xyz", points.T, strict=True))


def coordinates(vector: Float[np.ndarray, " 3"]) -> dict[str, float]:
    """Returns the vector in the form that plotly expects."""
    return dict(zip("xyz", vector.tolist(), strict=True))
