"""The basin map of a scale sweep: the sphere of normals, coloured by the optimum that is reached from there.

A plane is a pair of opposite points of the sphere, so that every view of half the sphere shows all planes.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float, Int, UInt8
from scipy.spatial import cKDTree

from symjax.geometry.local_frames import tangent_frames
from symjax.scale_sweep.optima import NOT_CONVERGED, Optimum
from symjax.viz import colours
from symjax.viz.colours import css
from symjax.viz.plotly_traces import coordinates

if TYPE_CHECKING:
    from symjax.scale_sweep.run import ScaleSweep

COLOURS: tuple[colours.Rgb, ...] = (
    colours.PLANE,
    colours.CLOUD,
    colours.MIRRORED,
    colours.PAIR,
    (132, 94, 194),
    (214, 176, 52),
    colours.REJECTED,
    colours.INK,
)
"""Colours of the best optimum, the next five, all others, and starts that did not converge."""

OTHERS, UNCONVERGED, EMPTY = len(COLOURS) - 2, len(COLOURS) - 1, len(COLOURS)
NAMES = ("best optimum", "2nd", "3rd", "4th", "5th", "6th", "other optima", "not converged")

TINT = 0.42
"""Fraction of the colour of a cell; the rest is white, so that starts and optima stand out."""

SUBDIVISIONS = 5
"""Subdivisions of the icosahedron whose triangles are coloured; their sides are 2 degrees."""

REACH, FARTHEST = 1.3, 0.4
"""A start colours the cells within this many spacings of evenly spread starts, and within this many radians."""

DOT, LIFT = 1.012, 1.03
"""Radii at which starts and optima are drawn, just above the sphere."""

FRAME, ZOOM = 1.3, 1.95
"""Half the side of the cube that is shown, and its aspect ratio, which scales an orthographic view."""

TILT = np.radians(24.0)
"""Angle between the viewing direction and the estimated normal."""


def colour_index(rank: Int[np.ndarray, "*n"]) -> UInt8[np.ndarray, "*n"]:
    """Returns the index in `COLOURS` of a rank."""
    return np.where(rank == NOT_CONVERGED, UNCONVERGED, np.minimum(rank, OTHERS)).astype(np.uint8)


class SphereMap:
    """Plotly traces of the basin map: those that are fixed, and those that change with σ."""

    def __init__(self, sweep: "ScaleSweep", optima: list[list[Optimum]]) -> None:
        """Prepares the triangles of the sphere.

        Args:
            sweep: the scale sweep.
            optima: the distinct optima at every σ.
        """
        self._sweep, self._optima = sweep, optima
        # trimesh is slow to import
        from trimesh.creation import icosphere

        sphere = icosphere(subdivisions=SUBDIVISIONS)
        self._vertices, self._faces = np.asarray(sphere.vertices), np.asarray(sphere.faces)
        centres = self._vertices[self._faces].mean(axis=1)
        self._centres = centres / np.linalg.norm(centres, axis=1, keepdims=True)

    def fixed(self) -> list[dict[str, Any]]:
        """Returns the traces that are fixed: the axes, the estimated normal, and the legend."""
        normal = np.asarray(self._sweep.estimated.plane.normal)
        return [*_legend(colour_index(self._sweep.rank)), _estimated(normal), _axes()]

    def at(self, index: int) -> list[dict[str, Any]]:
        """Returns three traces at the σ of this index: cells, starts and optima."""
        starts = self._sweep.fits.start
        if starts is None:
            normals, rank = np.zeros((0, 3)), np.zeros(0, int)
        else:
            normals, rank = np.asarray(starts.normal[index]), self._sweep.rank[index]
        return [self._cells(normals, rank), self._starts(normals, rank), self._marks(self._optima[index])]

    def changes(self, index: int) -> list[dict[str, Any]]:
        """Returns the properties of those three traces that change with σ, at the σ of this index."""
        cells, *points = self.at(index)
        varying = ("type", "x", "y", "z", "marker", "customdata", "text")
        return [
            {name: cells[name] for name in ("type", "intensity")},
            *({name: trace[name] for name in varying if name in trace} for trace in points),
        ]

    def _cells(self, normals: Float[np.ndarray, "r 3"], rank: Int[np.ndarray, " r"]) -> dict[str, Any]:
        """Returns the sphere, with every triangle in the colour of the nearest start, or white if none is near."""
        x, y, z = self._vertices.T.astype(np.float32)
        i, j, k = self._faces.T.astype(np.int32)
        tints = [(_tint(red), _tint(green), _tint(blue)) for red, green, blue in COLOURS]
        return {
            "type": "mesh3d",
            **{"x": x, "y": y, "z": z, "i": i, "j": j, "k": k},
            "intensity": self._cell_colours(normals, rank),
            "intensitymode": "cell",
            **_scale([*tints, (250, 250, 251)]),
            "showscale": False,
            "lighting": {"ambient": 0.86, "diffuse": 0.22, "specular": 0.0, "fresnel": 0.0},
            "flatshading": False,
            "hoverinfo": "skip",
            "scene": "scene",
        }

    def _cell_colours(self, normals: Float[np.ndarray, "r 3"], rank: Int[np.ndarray, " r"]) -> UInt8[np.ndarray, " f"]:
        if len(normals) == 0:
            return np.full(len(self._centres), EMPTY, np.uint8)
        # the starts divide half the sphere, of area 2π, among them
        reach = min(REACH * np.sqrt(2 * np.pi / len(normals)), FARTHEST)
        distance, nearest = cKDTree(np.concatenate([normals, -normals])).query(self._centres)
        of_nearest = colour_index(rank)[nearest % len(normals)]
        return np.where(distance < reach, of_nearest, EMPTY).astype(np.uint8)

    def _starts(self, normals: Float[np.ndarray, "r 3"], rank: Int[np.ndarray, " r"]) -> dict[str, Any]:
        both = DOT * np.concatenate([normals, -normals]).astype(np.float32)
        return {
            "type": "scatter3d",
            "mode": "markers",
            "name": "starts",
            **dict(zip("xyz", both.T, strict=True)),
            "marker": {
                "size": float(np.clip(64 / np.sqrt(max(len(normals), 1)), 1.5, 5.0)),
                "color": np.tile(colour_index(rank), 2),
                **_scale(COLOURS),
                "line": {"width": 0},
            },
            "customdata": np.tile(rank + 1, 2).astype(np.int32),
            "hovertemplate": "start (%{x:.3f}, %{y:.3f}, %{z:.3f})<br>reaches optimum %{customdata}<extra></extra>",
            "showlegend": False,
            "scene": "scene",
        }

    def _marks(self, optima: list[Optimum]) -> dict[str, Any]:
        """Returns the optima; their size shows how many starts reach them."""
        normals = np.reshape([optimum.plane.normal for optimum in optima], (-1, 3))
        rank = np.arange(len(optima))
        size = [7 + 11 * float(np.sqrt(optimum.fraction)) for optimum in optima]
        labels = [
            f"optimum {number} of {len(optima)}<br>{optimum.fraction:.1%} of the starts<br>loss {optimum.loss:.6g}"
            for number, optimum in enumerate(optima, start=1)
        ]
        return {
            "type": "scatter3d",
            "mode": "markers",
            "name": "optima",
            **dict(zip("xyz", LIFT * np.concatenate([normals, -normals]).T, strict=True)),
            "marker": {
                "symbol": "diamond",
                "size": size * 2,
                "color": np.tile(colour_index(rank), 2),
                **_scale(COLOURS),
                "line": {"width": 2, "color": css(colours.INK)},
                "opacity": 1.0,
            },
            "text": labels * 2,
            "hovertemplate": "%{text}<extra></extra>",
            "showlegend": False,
            "scene": "scene",
        }


def view(normal: Float[np.ndarray, " 3"]) -> dict[str, Any]:
    """Returns the scene, viewed from near the direction of the estimated normal."""
    up = -tangent_frames(normal)[:, 1]
    towards = np.cos(TILT) * normal - np.sin(TILT) * up
    hidden = {"visible": False, "range": [-FRAME, FRAME]}
    return {
        "xaxis": hidden,
        "yaxis": hidden,
        "zaxis": hidden,
        "aspectmode": "manual",
        "aspectratio": dict.fromkeys("xyz", ZOOM),
        "dragmode": "orbit",
        "camera": {
            "eye": coordinates(1.25 * towards),
            "up": coordinates(up),
            "projection": {"type": "orthographic"},
        },
    }


def _scale(steps: Sequence[colours.Rgb]) -> dict[str, Any]:
    """Returns a stepped colour scale, with colour k for the number k."""
    count = len(steps)
    edges = [[edge / count, css(colour)] for k, colour in enumerate(steps) for edge in (k, k + 1)]
    return {"colorscale": edges, "cmin": -0.5, "cmax": count - 0.5}


def _tint(channel: int) -> int:
    return round(TINT * channel + (1 - TINT) * 255)


def _axes() -> dict[str, Any]:
    tips = 1.17 * np.eye(3)
    ends = np.stack([0.98 * np.eye(3), tips, np.full((3, 3), np.nan)], axis=1).reshape(-1, 3)
    return {
        "type": "scatter3d",
        "mode": "lines+text",
        **dict(zip("xyz", ends.T, strict=True)),
        "text": [label for axis in "xyz" for label in ("", axis, "")],
        "textfont": {"size": 14, "color": css(colours.FAINT_INK)},
        "line": {"color": css(colours.REJECTED), "width": 3},
        "hoverinfo": "skip",
        "showlegend": False,
        "scene": "scene",
    }


def _estimated(normal: Float[np.ndarray, " 3"]) -> dict[str, Any]:
    ends = 1.12 * np.stack([normal, -normal])
    return {
        "type": "scatter3d",
        "mode": "markers",
        "name": "normal with estimated σ",
        **dict(zip("xyz", ends.T, strict=True)),
        "marker": {"symbol": "cross", "size": 6, "color": css(colours.INK)},
        "hovertemplate": "normal with estimated σ<extra></extra>",
        "scene": "scene",
    }


def _legend(used: UInt8[np.ndarray, "S R"]) -> list[dict[str, Any]]:
    """Returns an empty trace for each colour that occurs, for its entry in the legend."""
    return [
        {
            "type": "scatter3d",
            "mode": "markers",
            "name": NAMES[index],
            **{axis: [None] for axis in "xyz"},
            "marker": {"color": css(COLOURS[index]), "size": 8},
            "scene": "scene",
        }
        for index in np.unique(used)
    ]
