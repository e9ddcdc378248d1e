"""Solids without a mirror plane."""

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.animals import head_and_neck, torso_and_legs
from symjax.datasets.solids.csg import difference, fold, reflect, rotate, rotation_about, union
from symjax.datasets.solids.primitives import Field, box, capsule, cylinder, ellipsoid, frustum, sphere, torus, tube
from symjax.datasets.solids.solid import Solid, without_planes


def blobs(rng: np.random.Generator) -> Solid:
    """Six to nine ellipsoids of random size, each attached to an earlier one, with filleted joints."""
    centres, radii = [np.zeros(3)], [rng.uniform(0.15, 0.4, 3)]
    for _ in range(int(rng.integers(5, 9))):
        stem = rng.integers(len(centres))
        step = radii[stem] * _direction(rng)
        outward = centres[stem] + step
        centres.append(outward if np.abs(outward).max() < 1.2 else centres[stem] - step)
        radii.append(rng.uniform(0.1, 0.4, 3))
    parts = [ellipsoid(c, r) for c, r in zip(centres, radii, strict=True)]
    return without_planes(union(*parts, blend=0.06))


def scrap(rng: np.random.Generator) -> Solid:
    """Boxes, cylinders and cones at random angles, joined by rods and pierced by one hole."""
    parts: list[Field] = []
    at = np.zeros(3)
    for k in range(int(rng.integers(5, 8))):
        away = rng.uniform(0.3, 0.9) * _direction(rng)
        shape = (
            box(at, rng.uniform(0.1, 0.45, 3), 0.02),
            cylinder(at, at + away, rng.uniform(0.08, 0.25)),
            frustum(at, at + away, rng.uniform(0.15, 0.35), 0.05),
        )[k % 3]
        parts.append(rotate(rotate(shape, 0, rng.uniform(0, 90), at), 2, rng.uniform(0, 90), at))
        before, step = at, rng.uniform(0.3, 0.6) * _direction(rng)
        at = at + step if np.abs(at + step).max() < 0.8 else at - step
        parts.append(capsule(before, at, 0.07))
    hole = 0.5 * _direction(rng)
    return without_planes(difference(union(*parts), capsule(hole, -hole, 0.06)))


def left_boot(rng: np.random.Generator) -> Solid:
    """Boot of the left foot: curved inwards, with a buckle on the outer side and a leaning shaft."""
    length, shaft = rng.uniform(0.8, 1.1), rng.uniform(0.6, 1.1)
    inward, lean = rng.uniform(0.3, 0.45), rng.uniform(-0.35, -0.15)
    toe = np.array([inward, length, -0.05])
    parts = [
        capsule((0, -0.1, 0.05), (0.1 * inward, 0.45 * length, 0.05), 0.2, 0.24),
        capsule((0.1 * inward, 0.45 * length, 0.03), toe, 0.24, 0.17),
        capsule((-0.1, 0.4 * length, -0.05), toe + [-0.32, -0.15, 0], 0.17, 0.12),
        capsule((0, -0.05, 0.1), (lean, -0.1, shaft), 0.2, rng.uniform(0.24, 0.32)),
        box((0, -0.15, -0.25), (0.17, 0.14, 0.1), 0.02),
        torus((-0.27 + 0.4 * lean, 0.0, 0.45 * shaft), (1, 0, 0), 0.12, 0.04),
        capsule((-0.25 + 0.4 * lean, -0.1, 0.45 * shaft), (-0.45 + 0.4 * lean, -0.3, 0.5 * shaft), 0.06),
    ]
    opening = capsule((0.5 * lean, -0.08, 0.55 * shaft), (1.2 * lean, -0.1, shaft + 0.6), 0.15, 0.26)
    return without_planes(difference(union(*parts, blend=0.08), opening))


def tree(rng: np.random.Generator) -> Solid:
    """Twisted tree: a winding trunk and five to seven branches at irregular heights, some with crowns."""
    heights = np.linspace(-1.2, 0.7, 8)
    wind = rng.uniform(0.15, 0.3)
    turns = np.linspace(0, rng.uniform(3, 6), 8) + rng.uniform(0, 2 * np.pi)
    trunk = np.column_stack([wind * np.cos(turns), wind * np.sin(turns), heights])
    parts = [tube(trunk, np.linspace(0.17, 0.06, 8))]
    angle = rng.uniform(0, 2 * np.pi)
    for _ in range(int(rng.integers(5, 8))):
        angle += rng.uniform(0.6, 2.2)
        root = trunk[rng.integers(3, 8)]
        out = np.array([np.cos(angle), np.sin(angle), rng.uniform(0.2, 1.0)])
        bent = out @ rotation_about(2, rng.uniform(20, 60)).T
        middle = root + rng.uniform(0.2, 0.35) * out
        tip = middle + rng.uniform(0.25, 0.45) * bent
        parts.append(tube(np.array([root, middle, tip]), np.array([0.07, 0.05, 0.035])))
        if rng.random() < 0.6:
            parts.append(sphere(tip, rng.uniform(0.12, 0.3)))
    return without_planes(union(*parts, blend=0.04))


def turned_animal(rng: np.random.Generator) -> Solid:
    """Four-legged animal in mid-stride, with its head and its tail turned to a side."""
    seed = rng.integers(2**63)
    stride, swing = rng.uniform(0.25, 0.4), rng.choice([-1, 1]) * rng.uniform(0.4, 0.7)
    right = torso_and_legs(np.random.default_rng(seed), stride, swing)
    left = torso_and_legs(np.random.default_rng(seed), -stride, -swing)
    towards = rng.choice([-1, 1]) * rng.uniform(55, 85)
    looking = rotate(fold(head_and_neck(rng)), 2, towards, about=(0, 0.45, 0.1))
    return without_planes(union(union(right, reflect(left)), looking, blend=0.06))


def mountain(rng: np.random.Generator) -> Solid:
    """Mountain range: peaks of different heights on a flat base."""
    parts: list[Field] = [ellipsoid((0, 0, -0.3), (1.2, rng.uniform(0.7, 1.1), 0.25))]
    for _ in range(int(rng.integers(5, 9))):
        x, y = rng.uniform(-0.75, 0.75, 2) * [1, 0.8]
        h, r = rng.uniform(0.2, 1.3), rng.uniform(0.2, 0.5)
        lean = rng.uniform(-0.25, 0.25, 2)
        parts.append(capsule((x, y, -0.25), (x + lean[0], y + lean[1], h), r, 0.05 if h > r else 0.8 * r))
    from_below = box((0, 0, -2.35), (3, 3, 2))
    return without_planes(difference(union(*parts, blend=0.1), from_below))


def hand(rng: np.random.Generator) -> Solid:
    """Left hand with a bent wrist and four fingers curled by different amounts."""
    width, palm = rng.uniform(0.32, 0.42), rng.uniform(0.38, 0.5)
    parts = [
        box((0, 0, 0), (width, palm, 0.13), 0.12),
        capsule((-0.05, -palm, 0), (-rng.uniform(0.2, 0.4), -palm - 0.55, -rng.uniform(0.1, 0.4)), 0.2, 0.24),
    ]
    lengths = np.array([0.75, 0.9, 0.8, 0.55]) * rng.uniform(0.8, 1.2)
    r = 0.23 * width
    for k, length in enumerate(lengths):
        at = np.array([width * (0.75 - 0.5 * k), palm - 0.05, 0.0])
        pitch = 0.0
        knots = [at]
        curl = rng.uniform(0.1, 0.25) + 0.22 * k * rng.uniform(0.8, 1.2)
        for share in (0.45, 0.3, 0.25):
            pitch += curl
            at = at + share * length * np.array([0.12 * (1.5 - k), np.cos(pitch), np.sin(pitch)])
            knots.append(at)
        parts.append(tube(np.array(knots), np.array([r, 0.95 * r, 0.85 * r, 0.75 * r])))
    out = rng.uniform(0.25, 0.45)
    thumb = np.array([[0.7 * width, -0.5 * palm, 0.05], [width + out, 0.0, 0.25], [width + out + 0.05, 0.35, 0.5]])
    parts.append(tube(thumb, np.array([0.14, 0.1, 0.08])))
    return without_planes(union(*parts, blend=0.05))


def spring(rng: np.random.Generator) -> Solid:
    """Tapered spring with a hook at one end. A helix is chiral."""
    turns, steps = rng.uniform(1.6, 2.6), 40
    angle = np.linspace(0, 2 * np.pi * turns, steps)
    radius = np.linspace(rng.uniform(0.7, 1.0), rng.uniform(0.25, 0.5), steps)
    height = np.linspace(-0.8, rng.uniform(0.4, 0.9), steps)
    coil = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
    hook = coil[-1] + np.array([[0, 0, 0], [0, 0.1, 0.3], [0.3, 0.2, 0.4]])
    wire = rng.uniform(0.06, 0.11)
    return without_planes(union(tube(coil, wire), tube(hook, wire)))


def _direction(rng: np.random.Generator) -> Float[np.ndarray, " 3"]:
    """Returns a random unit vector."""
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)
