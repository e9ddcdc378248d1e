"""The Laplace-Beltrami spectrum of a point cloud, by the tufted Laplacian of its Delaunay stars.

Sharp and Crane, "A Laplacian for Nonmanifold Triangle Meshes", SGP 2020, build a point cloud's Laplacian
from the planar Delaunay star of every point in its tangent plane. The mesh routine of their library is
used here on stars of our own: the library's point-cloud routine divides the neighbours' centroid by one
too many when it estimates normals, which loses area on dense clouds and ties the result to where the cloud
stands.
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
"""Eigenfunctions k (the paper's number)."""

LaplacianKind = Literal["stars", "library"]

STAR_NEIGHBOURS = 30
"""Neighbours offered to each star (Sharp and Crane's number)."""

GENERAL_POSITION = 1e-9
"""Points are moved by this share of their extent, so that no two of the stars' triangles tie."""

SHIFT = -1e-2
"""Shift of the inverse iteration, for a cloud of unit area, whose first positive eigenvalues are of order ten."""


class Spectrum(NamedTuple):
    """Generalised eigenpairs L φ = λ M φ, eigenvalues ascending, φᵀ M φ = 1."""

    eigenvalues: Float[np.ndarray, " k"]
    eigenfunctions: Float[np.ndarray, "n k"]
    mass: Float[np.ndarray, " n"]

    @property
    def area(self) -> float:
        """Area of the surface, in squared units of the points."""
        return float(self.mass.sum())

    @property
    def num_components(self) -> int:
        """Number of eigenvalues that are zero to rounding: the pieces in which no heat is exchanged."""
        return int(np.count_nonzero(self.eigenvalues * self.area < ZERO_EIGENVALUE))


ZERO_EIGENVALUE = 1e-6
"""Eigenvalues below this, times the area, count as zero: one for every piece of the cloud."""


def delaunay_stars(
    points: Float[np.ndarray, "n 3"],
    neighbours: Int[np.ndarray, "n h"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
) -> Int[np.ndarray, "f 3"]:
    """All triangles (point, neighbour, neighbour) of the planar Delaunay star of every point, as one soup.

    Inverting the neighbours, projected to the tangent plane, in the unit circle about the point turns circles
    through the point into lines: the star's triangles are the edges of the inverted points' convex hull that
    have the point on their inner side. The hulls of all points are wrapped together, one edge a step.
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
        # rounding can turn a point on the last edge a hair to the right: that is no full turn
        turn = np.where(turn < -1e-9, turn + 2 * np.pi, turn)
        turn[np.arange(len(rows)), current] = np.inf
        turn[(step == 0).all(-1)] = np.inf
        following = np.argmin(turn, axis=1)
        p = inverted[rows, current]
        q = inverted[rows, following]
        inner = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] > 0
        triangles.append(np.stack([rows, neighbours[rows, current], neighbours[rows, following]], axis=1)[inner])
        heading = q - p
        open_ = following != start
        rows, current, start, heading = rows[open_], following[open_], start[open_], heading[open_]
        if not len(rows):
            break
    return np.concatenate(triangles)


def star_laplacian(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    num_neighbours: int = STAR_NEIGHBOURS,
) -> tuple[csc_matrix, Float[np.ndarray, " n"]]:
    """Tufted Laplacian L (positive semi-definite, sparse) and lumped mass of a point cloud.

    Args:
        points: distinct points; at least four.
        normals: surface normals, of either orientation; by default the neighbours' least principal direction.
        num_neighbours: neighbours offered to each star, capped at n - 1.

    Returns:
        L, dimensionless, and the mass, in squared units of the points.

    Raises:
        SpectrumError: the library refuses the stars.
    """
    count = min(num_neighbours, len(points) - 1)
    neighbours = cKDTree(points).query(points, k=count + 1)[1]
    # a point is its own nearest neighbour, whatever rounding says of near-duplicates
    itself = neighbours == np.arange(len(points))[:, None]
    itself[~itself.any(axis=1), -1] = True
    neighbours = neighbours[~itself].reshape(len(points), count)
    stars = delaunay_stars(points, neighbours, normals=normals)
    # Stars overlap, and the library glues equal triangles by a sort that ties: out of the tie's reach, rounding in the
    # points does not turn it.
    jitter = np.random.default_rng(0).normal(size=points.shape) * (GENERAL_POSITION * np.ptp(points))
    try:
        matrix, mass = robust_laplacian.mesh_laplacian(np.ascontiguousarray(points + jitter, dtype=float), stars)
    except RuntimeError as error:
        raise SpectrumError(f"the Laplacian of {len(points)} points could not be built: {error}") from error
    # every triangle of a Delaunay triangulation stands in the stars of its three corners
    return csc_matrix(matrix) / 3.0, mass.diagonal() / 3.0


def library_laplacian(
    points: Float[np.ndarray, "n 3"], *, num_neighbours: int = STAR_NEIGHBOURS
) -> tuple[csc_matrix, Float[np.ndarray, " n"]]:
    """Sharp and Crane's Laplacian of points by their library's own routine, which estimates the normals itself.

    It loses area on dense clouds and away from the origin; `experiments.run sphere` measures how much.
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
    """The k lowest eigenpairs of the cloud's Laplace-Beltrami operator.

    The problem is scaled to unit area for the solver, since a fixed shift needs a fixed scale, and scaled back.

    Args:
        points: distinct points, n > `num_eigs` + 1.
        normals: see `star_laplacian`.
        num_eigs: eigenpairs k, the constant one included.
        num_neighbours: neighbours offered to each star.
        laplacian: `"stars"`, see `star_laplacian`; or `"library"`, see `library_laplacian`.

    Returns:
        Eigenvalues in inverse squared units; eigenfunctions normalised by area.

    Raises:
        InvalidArgumentError: `num_eigs` is not in 1 … n - 2.
        SpectrumError: the eigensolver does not converge, also at a larger shift.
    """
    if not 1 <= num_eigs < len(points) - 1:
        raise InvalidArgumentError(
            f"num_eigs must be between 1 and {len(points) - 2} for {len(points)} points, not {num_eigs}"
        )
    if laplacian == "stars":
        matrix, mass = star_laplacian(points, normals=normals, num_neighbours=num_neighbours)
    else:
        matrix, mass = library_laplacian(points, num_neighbours=num_neighbours)
    area = float(mass.sum())
    if not np.isfinite(area) or area <= 0:
        raise SpectrumError(f"the Delaunay stars of {len(points)} points have no area: are they on one line?")
    # a point without triangles has no mass of its own: a trace of it keeps the mass matrix definite
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
    raise SpectrumError(f"the eigensolver did not converge on {len(points)} points, {num_eigs} eigenpairs")
