"""Solids with several mirror planes, and solids of revolution about z."""

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.csg import difference, fold, union
from symjax.datasets.solids.primitives import (
    Coordinates,
    Distances,
    Field,
    box,
    capsule,
    cylinder,
    ellipsoid,
    frustum,
    lathe,
    plate,
    sphere,
    torus,
)
from symjax.datasets.solids.solid import Solid, revolved, with_planes

X, Y, Z = np.eye(3).tolist()


def twofold(*parts: Field, blend: float = 0.0) -> Solid:
    """Unites the parts at x, y ≥ 0 with their mirror images across x = 0 and y = 0."""
    return with_planes(fold(fold(union(*parts, blend=blend), 0), 1), [X, Y])


def vertical_planes(count: int) -> list[list[float]]:
    """Returns the normals of the vertical mirror planes of a regular polygon with `count` corners, one at y = 0."""
    angles = np.pi * np.arange(count) / count
    normals: list[list[float]] = np.column_stack([-np.sin(angles), np.cos(angles), np.zeros(count)]).tolist()
    return normals


def dihedral(part: Field, count: int) -> Field:
    """Gives a part the dihedral symmetry of a regular polygon about z: `count` copies, each symmetric about its middle.

    The field is evaluated at the angle folded into [0, π/count], so the symmetry is exact up to rounding.
    """
    wedge = 2 * np.pi / count

    def field(p: Coordinates) -> Distances:
        radius, angle = np.hypot(p[0], p[1]), np.arctan2(p[1], p[0])
        angle = np.abs(angle - wedge * np.round(angle / wedge))
        return part(np.stack([radius * np.cos(angle), radius * np.sin(angle), p[2]]))

    return field


def block(rng: np.random.Generator) -> Solid:
    """Box with rounded edges and three different side lengths: three planes."""
    half = np.array([1.0, rng.uniform(0.6, 0.8), rng.uniform(0.3, 0.5)]) * rng.uniform(0.7, 1.2)
    return with_planes(fold(fold(fold(box((0, 0, 0), half, rng.uniform(0.0, 0.15)), 0), 1), 2), [X, Y, Z])


def three_axis_ellipsoid(rng: np.random.Generator) -> Solid:
    """Ellipsoid with three different axes: three planes."""
    radii = (1.0, rng.uniform(0.55, 0.8), rng.uniform(0.25, 0.45))
    return with_planes(fold(fold(fold(ellipsoid((0, 0, 0), radii), 0), 1), 2), [X, Y, Z])


def cube(rng: np.random.Generator) -> Solid:
    """Cube with rounded edges: nine planes."""
    half = rng.uniform(0.5, 0.9)
    diagonals = [[1, s, 0] for s in (1, -1)] + [[1, 0, s] for s in (1, -1)] + [[0, 1, s] for s in (1, -1)]
    normals = [X, Y, Z, *(np.array(diagonals) / np.sqrt(2)).tolist()]
    return with_planes(box((0, 0, 0), (half, half, half), rng.uniform(0.0, 0.2)), normals)


def table(rng: np.random.Generator) -> Solid:
    """Rectangular table with four legs: two planes."""
    w, d, h = rng.uniform(0.8, 1.3), rng.uniform(0.4, 0.65), rng.uniform(0.4, 0.9)
    inset = rng.uniform(0.06, 0.15)
    parts = [
        box((0, 0, 0), (w, d, 0.04), 0.02),
        frustum((w - inset, d - inset, 0), (w - inset + 0.05, d - inset + 0.05, -h), 0.06, 0.035),
        box((0, d - inset, -0.08), (w - inset, 0.025, 0.08), 0.01),
    ]
    return twofold(*parts)


def wing_nut(rng: np.random.Generator) -> Solid:
    """Wing nut, a bored hub with two wings: two planes."""
    r, reach, rise = rng.uniform(0.25, 0.4), rng.uniform(0.5, 0.9), rng.uniform(0.4, 0.8)
    wing = np.array([[0, -0.2], [r + reach, rise - 0.25], [r + reach, rise + 0.1], [r + 0.5 * reach, rise], [0.1, 0.2]])
    parts = [frustum((0, 0, -0.3), (0, 0, 0.35), 1.2 * r, r), plate(wing, (0, 2), 0, rng.uniform(0.05, 0.09), 0.03)]
    bored = difference(union(*parts, blend=0.05), cylinder((0, 0, -1), (0, 0, 1), 0.55 * r))
    return twofold(bored)


def prism(rng: np.random.Generator) -> Solid:
    """Regular prism of three to seven sides: one vertical plane a side, and a horizontal one."""
    count, h = int(rng.integers(3, 8)), rng.choice([rng.uniform(0.2, 0.45), rng.uniform(1.2, 1.5)])
    return with_planes(fold(dihedral(plate(_corners(count), (0, 1), 0, h), count), 2), [*vertical_planes(count), Z])


def pyramid(rng: np.random.Generator) -> Solid:
    """Regular pyramid of three to six sides: one vertical plane a side."""
    # heights near √2 are avoided: with three sides, that is a regular tetrahedron, which has three more planes
    count, h = int(rng.integers(3, 7)), rng.choice([rng.uniform(0.5, 1.1), rng.uniform(1.7, 1.85)])
    inner = float(np.cos(np.pi / count))
    slope = np.hypot(inner, h)

    def field(p: Coordinates) -> Distances:
        angle = np.pi / count  # outward direction of the half side that lies in the folded wedge
        out = p[0] * np.cos(angle) + p[1] * np.sin(angle)
        side = ((out - inner) * h + p[2] * inner) / slope
        distance: Distances = np.maximum(side, -p[2])
        return distance

    return with_planes(dihedral(field, count), vertical_planes(count))


def stool(rng: np.random.Generator) -> Solid:
    """Round stool with three to five legs and a ring: one plane a leg."""
    count, r, h = int(rng.integers(3, 6)), rng.uniform(0.35, 0.6), rng.uniform(0.5, 1.2)
    splay = rng.uniform(0.05, 0.3)
    leg = capsule((0.8 * r, 0, 0), (0.8 * r + splay, 0, -h), 0.055, 0.04)
    ring = torus((0, 0, -0.6 * h), (0, 0, 1), 0.8 * r + 0.6 * splay, 0.03)
    field = union(cylinder((0, 0, -0.05), (0, 0, 0.05), r, 0.03), leg, ring)
    return with_planes(dihedral(field, count), vertical_planes(count))


def _corners(count: int) -> Float[np.ndarray, "{count} 2"]:
    angles = 2 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(angles), np.sin(angles)])


def ball(rng: np.random.Generator) -> Solid:
    """Sphere: every line through its centre is an axis; one of them is given."""
    return revolved(sphere((0, 0, 0), rng.uniform(0.5, 1.0)))


def drum(rng: np.random.Generator) -> Solid:
    """Cylinder: an axis and a plane across it."""
    h = rng.choice([rng.uniform(0.1, 0.35), rng.uniform(0.9, 1.5)])
    return revolved(cylinder((0, 0, -h), (0, 0, h), rng.uniform(0.5, 0.7), rng.uniform(0.0, 0.08)), [Z])


def ring(rng: np.random.Generator) -> Solid:
    """Torus: an axis and a plane across it."""
    return revolved(torus((0, 0, 0), (0, 0, 1), rng.uniform(0.6, 1.0), rng.uniform(0.12, 0.4)), [Z])


def bowl(rng: np.random.Generator) -> Solid:
    """Bowl: a hollow spherical cap on a foot."""
    r, cap = rng.uniform(0.6, 1.0), rng.uniform(-0.3, 0.2)
    wall = rng.uniform(0.05, 0.1)
    shell = difference(sphere((0, 0, 0), r), sphere((0, 0, 0), r - wall), box((0, 0, cap * r + 2), (2, 2, 2)))
    return revolved(union(shell, cylinder((0, 0, -r - 0.1), (0, 0, -r + 0.08), 0.4 * r, 0.02)))


def vase(rng: np.random.Generator) -> Solid:
    """Vase: a hollow body with a random profile."""
    heights = np.linspace(-1, 1, 9)
    knots = rng.uniform(0.2, 0.7, 4)
    radii = np.polynomial.Polynomial.fit(np.linspace(-1, 1, 4), knots, 3)(heights)
    radii = np.maximum(radii, 0.15)
    outer = np.column_stack([radii, heights])
    inner = np.column_stack([radii - 0.07, heights])[:0:-1]
    return revolved(lathe(np.vstack([[0.0, -1.0], outer, inner, [0.0, heights[1]]])))


def goblet(rng: np.random.Generator) -> Solid:
    """Goblet: a foot, a stem and a hollow cup."""
    foot, cup, stem = rng.uniform(0.3, 0.5), rng.uniform(0.3, 0.55), rng.uniform(0.3, 0.8)
    depth = rng.uniform(0.4, 0.8)
    profile = [[0, 0], [foot, 0], [foot, 0.04], [0.06, 0.12], [0.05, stem], [0.7 * cup, stem + 0.15]]
    profile += [[cup, stem + 0.5 * depth], [0.95 * cup, stem + depth], [0.95 * cup - 0.05, stem + depth]]
    profile += [[cup - 0.05, stem + 0.5 * depth], [0.6 * cup, stem + 0.22], [0, stem + 0.17]]
    shifted = np.array(profile, dtype=float) - [0, (stem + depth) / 2]
    return revolved(lathe(shifted))
