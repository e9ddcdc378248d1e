"""Random points on the zero set of a signed distance function, uniform by area.

Points are drawn uniformly in the volume near the surface. Those in the shell |f| < ε |∇f|, of thickness 2ε, are kept
and moved onto the surface along the gradient. By Weyl's tube formula, the volume of a two-sided shell over a patch is
2ε · area · (1 + K ε²/3), where K is the Gaussian curvature. The density is therefore uniform to second order in ε. The
points are independent, and no triangles of a mesh can leave a pattern in them.
"""

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.primitives import Coordinates, Field
from symjax.errors import InvalidArgumentError

ROOT = 2.0
"""Half the side of the cube that contains every solid; the diagonals of the solids are about two to four."""

CELL = 1 / 32
"""Side of the cells that cover the surface. No thin part is lost, because a cell is dropped only if
|f(centre)| > LIPSCHITZ · half its diagonal, and not by the signs at its corners."""

SHELL = 0.004
"""Half the thickness of the shell, ε. All parts are at least 0.02 thick, so opposite shells do not meet."""

LIPSCHITZ = 1.5
"""Bound on |f| divided by the distance to the surface: 1 for exact distances, at most 1.5 for the ellipsoids used."""

STEP = 1e-6
"""Step of the finite differences."""

TOLERANCE = 1e-11
"""A point counts as on the surface if |f| is at most this."""

MAX_STEPS = 12
"""Limit on the Newton steps. A point that needs more is near a crease and is dropped."""

BATCH = 16384
"""Number of points evaluated at once, so that temporary arrays stay in the cache."""


def sample_surface(field: Field, num_points: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Draws independent random points, uniform by area on the zero set of `field` in the cube of side 2 `ROOT`.

    Raises:
        InvalidArgumentError: if the field has no zero in the cube.
    """
    cells = cover(field)
    if cells.shape[1] == 0:
        raise InvalidArgumentError(
            f"the field has no zero within {ROOT:g} of the origin: scale the solid to about unit size"
        )
    drawn = min(BATCH, 64 + 16 * num_points)  # about one in ten points is kept
    found = np.empty((3, 0))
    while found.shape[1] < num_points:
        corner = cells[:, rng.integers(cells.shape[1], size=drawn)] - CELL / 2
        p = corner + CELL * rng.random((3, drawn))
        p = p[:, np.abs(field(p)) < SHELL * LIPSCHITZ]
        found = np.hstack([found, project(field, p)])
    return found[:, :num_points].T.copy()


def cover(field: Field) -> Float[np.ndarray, "3 m"]:
    """Returns the centres of all cells of side `CELL` that may contain surface, found by subdividing the root cube."""
    size = ROOT / 4
    ticks = np.arange(-ROOT + size / 2, ROOT, size)
    centres = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij")).reshape(3, -1)
    octants = np.stack(np.meshgrid(*[[-0.25, 0.25]] * 3, indexing="ij")).reshape(3, 1, 8)
    while True:
        reach = LIPSCHITZ * size * np.sqrt(3) / 2 + SHELL
        kept = [c[:, np.abs(field(c)) < reach] for c in batches(centres)]
        centres = np.hstack(kept)
        if size <= CELL:
            return centres
        centres = (centres[:, :, None] + size * octants).reshape(3, -1)
        size /= 2


def batches(p: Coordinates) -> list[Float[np.ndarray, "3 b"]]:
    """Splits points into batches of at most `BATCH`."""
    return np.array_split(p, max(1, -(-p.shape[1] // BATCH)), axis=1)


def project(field: Field, p: Coordinates) -> Float[np.ndarray, "3 m"]:
    """Moves points of the shell |f| < ε |∇f| onto the surface by Newton steps along the gradient; drops all others."""
    value, slope = field(p), gradient(field, p)
    steepness = (slope**2).sum(axis=0)
    inside = np.abs(value) < SHELL * np.sqrt(steepness)
    p, value, slope, steepness = p[:, inside], value[inside], slope[:, inside], steepness[inside]
    order = np.arange(p.shape[1])
    done = np.zeros(p.shape[1], dtype=bool)
    active = order
    for _ in range(MAX_STEPS):
        p[:, active] -= slope * (value / steepness)
        value = field(p[:, active])
        on = np.abs(value) <= TOLERANCE
        done[active[on]] = True
        active, value = active[~on], value[~on]
        if active.size == 0:
            break
        slope = gradient(field, p[:, active])
        steepness = np.maximum((slope**2).sum(axis=0), 1e-3)
    return p[:, done]


def gradient(field: Field, p: Coordinates) -> Coordinates:
    """Computes the gradient from values at the corners of a small tetrahedron, to second order in the step."""
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
    slope = np.zeros_like(p)
    for corner in corners:
        slope += corner[:, None] * field(p + STEP * corner[:, None])
    return slope / (4 * STEP)
