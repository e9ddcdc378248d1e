"""Cost landscapes on the sphere of normals as the share of outlier pairs grows: the paper's second figure (fig:rh).

The upper row of the figure shows the pairs, the middle row the least-squares (maximum-likelihood) cost, and the lower
row the L2E cost −f. Each map shows the minimum of the cost over the offset, on the half sphere of normals in an
azimuthal equal-area projection. The table has the angle between the estimated and the planted plane.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from experiments.data import PLANTED
from experiments.data.planted_planes import METHODS, PLACES, angle, pairs, planes
from experiments.framework import figures
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.datasets.planted_pairs import PlantedPairs
from symjax.l2e.manifolds import tangent_basis
from symjax.l2e.objective import l2e_objective, squared_residuals

TILT = 0.7
"""Angle in radians between the planted normal and the centre of the maps, so that its mark is not at the centre."""

NUM_OFFSETS = 61
"""Number of offsets over which the L2E cost of a normal is minimised."""

MAX_DRAWN = 60
"""Number of pairs that are drawn."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        shares: shares of outlier pairs.
        blob: kind of blob.
        place: position of the outliers in the figure, "within" the blob or "beside" it.
        num_pairs: number of pairs.
        sigma: scale σ of the residual; larger than in the other studies, where the minimum of L2E would be a dot.
        pixels: width of a map.
        seed: seed of the pairs.
    """

    shares: tuple[float, ...] = (0.0, 0.25, 0.5, 0.65, 0.8)
    blob: str = "isotropic"
    place: str = "beside"
    num_pairs: int = 200
    sigma: float = 0.2
    pixels: int = 161
    seed: int = 0


SIZES = {"full": Config(), "small": Config(shares=(0.0, 0.65), pixels=41)}


def run(config: Config) -> list[Row]:
    """Returns one row per position of the outliers, share of outliers and method."""
    rows = []
    with jax.enable_x64(True):
        for place in PLACES:
            for share in config.shares:
                cloud = pairs([config.seed], config.num_pairs, share, config.blob, place)
                for method, plane in planes(cloud.x, cloud.y, config.sigma).items():
                    row = {"outliers": place, "share": share, "method": method}
                    row |= {f"normal_{axis}": float(plane.normal[i]) for i, axis in enumerate("xyz")}
                    rows.append(row | {"offset": float(plane.offset), "angle": angle(plane, cloud)})
    return rows


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates the deviation angles of all methods in degrees, one line per position and share of outliers."""
    lines: dict[tuple[str, float], Row] = {}
    for row in rows:
        line = lines.setdefault((row["outliers"], row["share"]), {"outliers": row["outliers"], "share": row["share"]})
        line[f"{row['method']}, deg"] = row["angle"]
    return [{**line, "paper": "L2 moves away, L2E stays"} for line in lines.values()]


@jax.jit
def _costs(
    normals: Float[Array, "p 3"], sigma: float, x: Float[Array, "n 3"], y: Float[Array, "n 3"]
) -> tuple[Float[Array, " p"], Float[Array, " p"]]:
    """Mean squared residual and −f of Eq. 5, both at the best offset of every normal."""

    def cost(v: Float[Array, " 3"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        mean = jnp.mean(0.5 * (x + y), axis=0)
        squares = jnp.mean(squared_residuals(v, jnp.sum(v * mean), x, y))
        shares = jnp.asarray((np.arange(NUM_OFFSETS) + 0.5) / NUM_OFFSETS, x.dtype)
        offsets = jnp.quantile(jnp.sum(0.5 * (x + y) * v[None, :], axis=1), shares)
        return squares, -jnp.max(jax.vmap(lambda omega: l2e_objective(v, omega, jnp.asarray(sigma), x, y))(offsets))

    costs: tuple[Float[Array, " p"], Float[Array, " p"]] = jax.lax.map(cost, normals, batch_size=64)
    return costs


def _from_disc(disc: Float[np.ndarray, "p 2"], frame: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "p 3"]:
    """Maps points of the unit disc to normals: the inverse of Lambert's equal-area projection of a half sphere."""
    square = np.minimum((disc**2).sum(axis=1, keepdims=True), 1.0)
    normals: Float[np.ndarray, "p 3"] = np.concatenate([disc * np.sqrt(2 - square), 1 - square], axis=1) @ frame.T
    return normals


def _onto_disc(normal: Float[np.ndarray, " 3"], frame: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, " 2"]:
    local = normal @ frame
    local = local if local[2] >= 0 else -local
    disc: Float[np.ndarray, " 2"] = local[:2] / np.sqrt(1 + local[2])
    return disc


def _frame(cloud: PlantedPairs) -> Float[np.ndarray, "3 3"]:
    """Axes of the maps as columns; the last is the normal at the centre of the map."""
    basis = np.asarray(tangent_basis(jnp.asarray(cloud.normal)))
    middle = np.cos(TILT) * cloud.normal + np.sin(TILT) * (basis[:, 0] + basis[:, 1]) / np.sqrt(2)
    return np.column_stack([np.asarray(tangent_basis(jnp.asarray(middle))), middle])


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws three rows of panels, one column per share of outliers."""
    from matplotlib.patches import Circle

    columns = len(config.shares)
    figure = figures.new(2.9 * columns, 9.2)
    ticks = np.linspace(-1, 1, config.pixels)
    disc = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    inside = (disc**2).sum(axis=1) <= 1
    for column, share in enumerate(config.shares):
        cloud = pairs([config.seed], config.num_pairs, share, config.blob, config.place)
        found = {row["method"]: row for row in rows if (row["share"], row["outliers"]) == (share, config.place)}
        ax: Any = figure.add_subplot(3, columns, 1 + column, projection="3d")
        _draw_pairs(ax, cloud)
        ax.set_title(f"{share:.0%} outlier pairs", fontsize=11)
        with jax.enable_x64(True):
            frame = _frame(cloud)
            costs = _costs(_from_disc(disc[inside], frame), config.sigma, cloud.x, cloud.y)
        marks = (
            ("L2 cost", METHODS[2], "red", np.asarray(costs[0])),
            ("L2E cost −f", METHODS[1], "blue", np.asarray(costs[1])),
        )
        for line, (title, method, colour, cost) in enumerate(marks):
            ax = figure.add_subplot(3, columns, 1 + (line + 1) * columns + column)
            image = np.full(len(disc), np.nan)
            image[inside] = cost
            ax.pcolormesh(
                ticks, ticks, image.reshape(len(ticks), -1), cmap="viridis", shading="nearest", rasterized=True
            )
            ax.add_patch(Circle((0, 0), 1, fill=False, color="black", linewidth=0.8))
            fitted = np.array([found[method][f"normal_{axis}"] for axis in "xyz"])
            for label, normal, face, size in (("true", cloud.normal, "lime", 90), (method, fitted, colour, 45)):
                ax.scatter(*_onto_disc(normal, frame), s=size, color=face, edgecolor="white", label=label, zorder=3)
            ax.set_title(f"{title}: {found[method]['angle']:.2g}° off", fontsize=9)
            ax.set_aspect("equal")
            ax.axis("off")
            if column == 0:
                ax.legend(fontsize=7, loc="lower left")
    figures.save(figure, path)


def _draw_pairs(ax: Any, cloud: PlantedPairs) -> None:
    """Draws pairs as lines, inliers in orange and outliers in blue, as in the paper."""
    chosen = np.linspace(0, len(cloud.x) - 1, MAX_DRAWN).astype(int)
    for i in chosen:
        ends = np.stack([cloud.x[i], cloud.y[i]])
        inlier = cloud.inlier[i]
        ax.plot(*ends.T, color="tab:orange" if inlier else "tab:blue", linewidth=0.8, alpha=0.9 if inlier else 0.5)
    ax.set_box_aspect(np.maximum(np.ptp(np.concatenate([cloud.x, cloud.y]), axis=0), 1e-9))
    ax.axis("off")


STUDY = Study("landscape", __doc__, SIZES, run, summary, draw=draw, data=PLANTED, paper="its second figure")
