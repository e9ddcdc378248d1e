"""The Laplace-Beltrami spectrum of a point cloud, by the tufted Laplacian of its Delaunay stars.

Sharp and Crane, "A Laplacian for Nonmanifold Triangle Meshes", SGP 2020, build the Laplacian of a point cloud from the
planar Delaunay star of every point in its tangent plane. This module builds the stars itself and calls the mesh
routine of their library. The library's own point-cloud routine, when it estimates normals, divides the sum of the
neighbours by their number plus one. That loses area on dense clouds and makes the result depend on the position of
the cloud.
"""

from typing import Literal, NamedTuple

import numpy as np
import robust_laplacian
from jaxtyping import Float, Int
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import ArpackError, eigsh
from scipy.spatial import cKDTree

from symjax.errors import InvalidArgumentError, SpectrumError
from symjax.geometry.local_frames import local_frames, tangent_frames

NUM_EIGS = 20
"""Number of eigenfunctions k (the paper's value)."""

LaplacianKind = Literal["stars", "library"]

STAR_NEIGHBOURS = 30
"""Number of neighbours from which each star is built (Sharp and Crane's value)."""

GENERAL_POSITION = 1e-9
"""Points are moved by this fraction of their extent, so that triangles do not tie in the library's sort."""

SHIFT = -1e-2
"""Shift of the eigensolver's shift-invert mode. The first positive eigenvalues at unit area are of order 10."""


class Spectrum(NamedTuple):
    """Generalised eigenpairs L φ = λ M φ of a cloud.

    Attributes:
        eigenvalues: ascending, in inverse squared units of the points.
        eigenfunctions: one a column, with φᵀ M φ = 1.
        mass: diagonal of the mass matrix M: the area that belongs to each point.
    """

    eigenvalues: Float[np.ndarray, " k"]
    eigenfunctions: Float[np.ndarray, "n k"]
    mass: Float[np.ndarray, " n"]

    @property
    def area(self) -> float:
        """Area of the surface, in squared units of the points."""
        return float(self.mass.sum())

    @property
    def num_components(self) -> int:
        """Number of connected components: of eigenvalues that are zero up to rounding."""
        return int(np.count_nonzero(self.eigenvalues * self.area < ZERO_EIGENVALUE))


ZERO_EIGENVALUE = 1e-6
"""An eigenvalue counts as zero if its product with the area is below this; every connected component has one."""


def delaunay_stars(
    points: Float[np.ndarray, "n 3"],
    neighbours: Int[np.ndarray, "n h"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
) -> Int[np.ndarray, "f 3"]:
    """Builds the planar Delaunay star of every point: its triangles (point, neighbour, neighbour).

    The neighbours are projected to the tangent plane and inverted in the unit circle about the point. Inversion turns
    circles through the point into lines. The triangles of the star are therefore the edges of the convex hull of the
    inverted neighbours that have the point on their inner side. Gift wrapping finds the hulls of all points together,
    one edge a step.

    Args:
        points: the cloud.
        neighbours: rows of the neighbours of every point, without the point itself.
        normals: surface normals of either orientation; by default estimated from the neighbours.

    Returns:
        The triangles of all stars, as rows of the points.
    """
    tangents = local_frames(points, neighbours)[1][:, :, 1:] if normals is None else tangent_frames(normals)
    offsets = points[neighbours] - points[:, None, :]
    plane = offsets @ tangents
    squared = np.maximum((plane**2).sum(-1, keepdims=True), np.finfo(float).tiny)
    inverted = plane / squared

    rows = np.arange(len(points))
    current = np.argmin(inverted[:, :, 1], axis=1)
    start = current.copy()
    heading = np.tile([1.0, 0.0], (len(points), 1))
    triangles = []
    for _ in range(neighbours.shape[1]):
        step = inverted[rows] - inverted[rows, current][:, None, :]
        along = (step * heading[:, None, :]).sum(-1)
        left = heading[:, None, 0] * step[..., 1] - heading[:, None, 1] * step[..., 0]
        turn = np.arctan2(left, along)
        # rounding can move a point on the last edge slightly to the right: that is not a full turn
        turn = np.where(turn < -1e-9, turn + 2 * np.pi, turn)
        turn[np.arange(len(rows)), current] = np.inf
        turn[(step == 0).all(-1)] = np.inf
        following = np.argmin(turn, axis=1)
        p = inverted[rows, current]
        q = inverted[rows, following]
        inner = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] > 0
        triangles.append(np.stack([rows, neighbours[rows, current], neighbours[rows, following]], axis=1)[inner])
        heading = q - p
        unfinished = following != start
        rows, start, heading = rows[unfinished], start[unfinished], heading[unfinished]
        current = following[unfinished]
        if not len(rows):
            break
    return np.concatenate(triangles)


def star_laplacian(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    num_neighbours: int = STAR_NEIGHBOURS,
) -> tuple[csc_matrix, Float[np.ndarray, " n"]]:
    """Computes the tufted Laplacian L (positive semi-definite, sparse) and the lumped mass of a point cloud.

    Args:
        points: distinct points; at least four.
        normals: surface normals of either orientation; by default the least principal direction of the neighbours.
        num_neighbours: number of neighbours from which each star is built, at most n − 1.

    Returns:
        L, dimensionless, and the mass of every point, in squared units of the points.

    Raises:
        SpectrumError: if the library cannot build the Laplacian of the stars.
    """
    count = min(num_neighbours, len(points) - 1)
    neighbours = cKDTree(points).query(points, k=count + 1)[1]
    # remove every point from its own neighbours; near-duplicates may come before it
    itself = neighbours == np.arange(len(points))[:, None]
    itself[~itself.any(axis=1), -1] = True
    neighbours = neighbours[~itself].reshape(len(points), count)
    stars = delaunay_stars(points, neighbours, normals=normals)
    # Stars overlap, and the library glues equal triangles in the order of a sort. The jitter avoids ties in that sort,
    # which rounding in the points would break.
    jitter = np.random.default_rng(0).normal(size=points.shape) * (GENERAL_POSITION * np.ptp(points))
    try:
        matrix, mass = robust_laplacian.mesh_laplacian(np.ascontiguousarray(points + jitter, dtype=float), stars)
    except RuntimeError as error:
        raise SpectrumError(f"the Laplacian of {len(points)} points could not be built: {error}") from error
    # every triangle of a Delaunay triangulation is in the stars of its three corners
    return csc_matrix(matrix) / 3.0, mass.diagonal() / 3.0


def library_laplacian(
    points: Float[np.ndarray, "n 3"], *, num_neighbours: int = STAR_NEIGHBOURS
) -> tuple[csc_matrix, Float[np.ndarray, " n"]]:
    """Computes Sharp and Crane's Laplacian by the point-cloud routine of their library, which estimates the normals.

    It loses area on dense clouds and away from the origin; `experiments.run sphere` measures how much.

    Args:
        points: distinct points.
        num_neighbours: number of neighbours from which each star is built, at most n − 1.

    Returns:
        L, dimensionless, and the mass of every point, in squared units of the points.
    """
    matrix, mass = robust_laplacian.point_cloud_laplacian(
        np.ascontiguousarray(points, dtype=float), n_neighbors=min(num_neighbours, len(points) - 1)
    )
    return csc_matrix(matrix), mass.diagonal()


def spectrum(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    num_eigs: int = NUM_EIGS,
    num_neighbours: int = STAR_NEIGHBOURS,
    laplacian: LaplacianKind = "stars",
) -> Spectrum:
    """Computes the k lowest eigenpairs of the Laplace-Beltrami operator of a cloud.

    The eigensolver works on the cloud scaled to unit area, since its shift is fixed; the result is scaled back.

    Args:
        points: distinct points, n > `num_eigs` + 1.
        normals: surface normals of either orientation, for `"stars"`; estimated if None.
        num_eigs: number of eigenpairs k, including the constant eigenfunction.
        num_neighbours: number of neighbours from which each star is built.
        laplacian: `"stars"`, see `star_laplacian`; or `"library"`, see `library_laplacian`.

    Returns:
        The eigenpairs and the mass.

    Raises:
        InvalidArgumentError: if `num_eigs` is not in 1 … n − 2.
        SpectrumError: if the Laplacian cannot be built, or the eigensolver does not converge, even at a larger shift.
    """
    if not 1 <= num_eigs < len(points) - 1:
        raise InvalidArgumentError(
            f"num_eigs must be between 1 and {len(points) - 2} for {len(points)} points, got {num_eigs}"
        )
    if laplacian == "stars":
        matrix, mass = star_laplacian(points, normals=normals, num_neighbours=num_neighbours)
    else:
        matrix, mass = library_laplacian(points, num_neighbours=num_neighbours)
    area = float(mass.sum())
    if not np.isfinite(area) or area <= 0:
        raise SpectrumError(f"the Delaunay stars of {len(points)} points have no area: do the points lie on one line?")
    # a point without triangles has no mass: a small one keeps the mass matrix positive definite
    unit_mass = np.maximum(mass / area, 1e-6 / len(points))
    mass_matrix = csc_matrix((unit_mass, (np.arange(len(points)), np.arange(len(points)))))
    start = np.random.default_rng(0).normal(size=len(points))
    for shift in (SHIFT, 100 * SHIFT):
        try:
            values, functions = eigsh(matrix, num_eigs, mass_matrix, sigma=shift, which="LM", v0=start)
        except (ArpackError, RuntimeError):
            continue
        order = np.argsort(values)
        return Spectrum(np.maximum(values[order], 0.0) / area, functions[:, order] / np.sqrt(area), unit_mass * area)
    raise SpectrumError(f"the eigensolver did not converge for {num_eigs} eigenpairs of {len(points)} points")
