"""Quadrics: a smooth patch of the surface around every point, fitted to its neighbours."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.local_frames import tangent_frames
from symjax.geometry.similarity import Similarity
from symjax.robust.surface import Surface

CLEAN_NEIGHBOURS, NOISY_NEIGHBOURS = 12, 16
"""Neighbours to which the six coefficients of a quadric are fitted. Measured median errors of the plane: on clean
clouds 0.002° with 12 and 0.004° with 16; with noise of 1 % of the diagonal 0.16° with 12, 0.11° with 16 and 0.15° with
20, since larger neighbourhoods round off thin parts."""

SCATTER_NEIGHBOUR = 3
"""The scatter of a point is its height above the quadric of this neighbour. Its own quadric was fitted to the point
itself."""

RIDGE = 1e-6
"""Ridge of the least-squares fit, relative to the trace. Few or flat neighbours do not determine all coefficients."""


class Quadrics(NamedTuple):
    """The surface over the tangent plane of every point: z = c₀ + c₁u + c₂w + c₃u² + c₄uw + c₅w².

    Attributes:
        frames: map from space to the local coordinates of each point: u and w along two tangents, z along the normal.
        coefficients: c₀ … c₅.
        radius: radius of the neighbourhood that each quadric was fitted to.
        scatter: standard deviation of the points about the quadrics of their neighbours, estimated by the median. It is
            about 0.7 of the noise, since the quadrics follow a part of the noise.
    """

    frames: Similarity
    coefficients: Float[np.ndarray, "n 6"]
    radius: Float[np.ndarray, " n"]
    scatter: float

    def frames_of(self, rows: Int[np.ndarray, " m"]) -> Similarity:
        """Returns the frames of some of the points."""
        return Similarity(self.frames.scale, np.asarray(self.frames.rotation)[rows], self.frames.shift[rows])

    def heights(self, points: Float[np.ndarray, "m 3"], rows: Int[np.ndarray, " m"]) -> Float[np.ndarray, " m"]:
        """Returns the height of each point above the quadric of the corresponding row."""
        u, w, z = np.asarray(self.frames_of(rows).points(points)).T
        heights: Float[np.ndarray, " m"] = z - (self.coefficients[rows] * _monomials(u, w)).sum(axis=1)
        return heights


def fit_quadrics(surface: Surface, *, size: int | None = None) -> Quadrics:
    """Fits a quadric around every point of a surface, by least squares weighted with the point confidence.

    Args:
        surface: the surface.
        size: number of neighbours to which a quadric is fitted; None for one that suits the noise.
    """
    count = size or (NOISY_NEIGHBOURS if surface.noisy else CLEAN_NEIGHBOURS)
    distances, neighbours = surface.tree.query(surface.points, k=min(count + 1, len(surface.points)), workers=-1)
    return _fitted(surface, neighbours, distances[:, -1])


def _fitted(surface: Surface, neighbours: Int[np.ndarray, "n k"], radius: Float[np.ndarray, " n"]) -> Quadrics:
    axes = np.concatenate([tangent_frames(surface.normals), surface.normals[:, :, None]], axis=2)
    frames = Similarity(1.0, axes, surface.points).inverse()
    per_neighbour = Similarity(1.0, np.asarray(frames.rotation)[:, None], frames.shift[:, None])
    local = np.asarray(per_neighbour.points(surface.points[neighbours]))
    # in units of the radius, so that the ridge affects all terms alike
    u, w, z = np.moveaxis(local / radius[:, None, None], -1, 0)
    terms = _monomials(u, w)
    weighted = terms * surface.confidence[neighbours][..., None]
    matrix = np.matmul(weighted.transpose(0, 2, 1), terms)
    trace = np.trace(matrix, axis1=1, axis2=2)
    matrix += (RIDGE * trace + np.finfo(float).tiny)[:, None, None] * np.eye(6)
    solution = np.linalg.solve(matrix, np.matmul(weighted.transpose(0, 2, 1), z[..., None]))[..., 0]
    powers = np.array([1, 0, 0, -1, -1, -1])
    quadrics = Quadrics(frames, solution * radius[:, None] ** powers, radius, 0.0)
    scatter = quadrics.heights(surface.points, neighbours[:, SCATTER_NEIGHBOUR])
    return quadrics._replace(scatter=float(1.4826 * np.median(np.abs(scatter))))


def _monomials(u: Float[np.ndarray, "*n"], w: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n 6"]:
    return np.stack([np.ones_like(u), u, w, u * u, u * w, w * w], axis=-1)
