"""Random points on the zero set of a signed distance function, uniform by area.

Points are drawn uniformly in the volume near the surface and kept where |f| < ε |∇f|, a shell of thickness 2ε;
the kept ones are moved onto the surface along the gradient. By Weyl's tube formula the volume of a two-sided
shell above a patch is 2ε · area · (1 + K ε²/3), K the Gaussian curvature: the density is uniform to second
order in ε, with no mesh whose triangles could leave a trace, and the points are independent.
"""

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.primitives import Field
from symjax.errors import InvalidArgumentError

ROOT = 2.0
"""Half the side of the cube in which solids are built, so their diagonals are about two to four."""

CELL = 1 / 32
"""Side of the cells that cover the surface. Thin parts cannot be lost: cells are dropped by the bound
|f(centre)| > LIPSCHITZ · half diagonal, not by signs at corners."""

SHELL = 0.004
"""Half thickness ε of the shell: parts are at least 0.02 thick, so shells of opposite sides do not meet."""

LIPSCHITZ = 1.5
"""Bound on |f| over the distance to the surface: 1 for exact distances, at most 1.5 for the ellipsoids in use."""

STEP = 1e-6
"""Step of the finite differences."""

TOLERANCE = 1e-11
"""A point is on the surface when |f| is at most this."""

MAX_STEPS = 12
"""Newton steps; a point that needs more sits on a crease, and is drawn again."""

BATCH = 16384
"""Points evaluated at a time: temporaries stay in the cache."""


def sample_surface(field: Field, num_points: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Independent random points, uniform by area on the zero set of `field` within the cube of side 2 `ROOT`.

    Raises:
        InvalidArgumentError: The field has no surface there.
    """
    cells = cover(field)
    if cells.shape[1] == 0:
        raise InvalidArgumentError("the field has no zero inside the cube: scale the solid to about unit size")
    drawn = min(BATCH, 64 + 16 * num_points)  # about one in ten is kept
    found = np.empty((3, 0))
    while found.shape[1] < num_points:
        corner = cells[:, rng.integers(cells.shape[1], size=drawn)] - CELL / 2
        p = corner + CELL * rng.random((3, drawn))
        p = p[:, np.abs(field(p)) < SHELL * LIPSCHITZ]
        found = np.hstack([found, project(field, p)])
    return found[:, :num_points].T.copy()


def cover(field: Field) -> Float[np.ndarray, "3 m"]:
    """Centres of the cells of side `CELL` that the surface can pass through, by halving from the root cube."""
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


def batches(p: Float[np.ndarray, "3 n"]) -> list[Float[np.ndarray, "3 b"]]:
    """The points in pieces of at most `BATCH`."""
    return np.array_split(p, max(1, -(-p.shape[1] // BATCH)), axis=1)


def project(field: Field, p: Float[np.ndarray, "3 n"]) -> Float[np.ndarray, "3 m"]:
    """Points of the shell |f| < ε |∇f|, moved onto the surface by Newton's method along the gradient."""
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


def gradient(field: Field, p: Float[np.ndarray, "3 n"]) -> Float[np.ndarray, "3 n"]:
    """Gradient from the values at the corners of a small tetrahedron, second order in the step."""
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
    slope = np.zeros_like(p)
    for corner in corners:
        slope += corner[:, None] * field(p + STEP * corner[:, None])
    return slope / (4 * STEP)
