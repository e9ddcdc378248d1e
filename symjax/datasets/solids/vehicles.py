"""Vehicles with one mirror plane, x = 0. y points forward and z up."""

import numpy as np

from symjax.datasets.solids.csg import difference, intersection, rotate, translate, union
from symjax.datasets.solids.primitives import (
    Field,
    box,
    capsule,
    cylinder,
    ellipsoid,
    frustum,
    halfspace,
    plate,
    sphere,
    torus,
    tube,
)
from symjax.datasets.solids.solid import Solid, mirrored


def car(rng: np.random.Generator) -> Solid:
    """Car: a body of random profile (bonnet, cabin, boot), wheels, mirrors and lamps, with or without a spoiler."""
    w, length = rng.uniform(0.38, 0.6), rng.uniform(0.85, 1.3)
    sill, waist, roof = -0.18, rng.uniform(0.12, 0.25), rng.uniform(0.42, 0.75)
    bonnet, boot = rng.uniform(0.25, 0.55) * length, rng.uniform(0.6, 0.95) * length
    nose = rng.uniform(0, 0.1)
    body = np.array([[-length, sill], [length, sill], [length, waist - nose - 0.08], [bonnet, waist], [-length, waist]])
    cabin = np.array(
        [[bonnet, waist - 0.05], [bonnet - rng.uniform(0.15, 0.4), roof], [-0.55 * boot, roof], [-boot, waist - 0.05]]
    )
    wheel = rng.uniform(0.2, 0.3)
    places = [(0.62 * length, sill), (-0.62 * length, sill)]
    arches = [cylinder((w - 0.2, *at), (w + 0.2, *at), wheel + 0.05) for at in places]
    parts = [
        difference(plate(body, (1, 2), 0, w, 0.07), *arches),
        plate(cabin, (1, 2), 0, w - 0.07, 0.05),
        *[cylinder((w - 0.17, *at), (w - 0.01, *at), wheel, 0.03) for at in places],
        *[cylinder((w - 0.02, *at), (w + 0.02, *at), 0.4 * wheel, 0.01) for at in places],
        ellipsoid((w + 0.06, bonnet - 0.2, waist + 0.08), (0.08, 0.04, 0.05)),
        sphere((w - 0.13, length - 0.05, waist - nose - 0.17), 0.09),
    ]
    if rng.random() < 0.5:
        parts.append(box((0, -length + 0.08, waist + 0.12), (w - 0.05, 0.08, 0.025), 0.02))
        parts.append(box((0.6 * w, -length + 0.08, waist + 0.05), (0.03, 0.05, 0.08), 0.01))
    return mirrored(*parts)


def aeroplane(rng: np.random.Generator) -> Solid:
    """Aeroplane: fuselage, swept wings, tail, and engines under the wings or a propeller on the nose."""
    span, length = rng.uniform(0.9, 1.5), rng.uniform(0.7, 1.2)
    body = rng.uniform(0.1, 0.17)
    level, rise = rng.choice([-0.5, 0.6]) * body, rng.uniform(0, 8)
    root, tip = rng.uniform(0.25, 0.42), rng.uniform(0.1, 0.22)
    sweep = rng.uniform(0.02, 0.6)
    wing = np.array([[0, root], [0, -root], [span, -sweep - tip], [span, -sweep + tip]]) * [1, 0.8]
    stabiliser = np.array([[0, 0.16], [0, -0.12], [0.35 * span, -0.22], [0.35 * span, -0.06]])
    fin = np.array([[0.22, 0], [-0.12, 0], [-0.22, 0.4], [-0.06, 0.4]]) * [1, rng.uniform(0.7, 1.3)]
    parts: list[Field] = [
        capsule((0, 0.6 * length, 0), (0, -0.4 * length, 0), body),
        capsule((0, -0.4 * length, 0), (0, -length, 0.06), body, 0.05),
        ellipsoid((0, 0.6 * length, 0.5 * body), (0.6 * body, 0.25, 0.8 * body)),
        rotate(plate(wing, (0, 1), level, 0.03, 0.02), 1, -rise, (0, 0, level)),
        translate(plate(stabiliser, (0, 1), 0.06, 0.025, 0.015), (0, -0.9 * length, 0)),
        translate(plate(fin, (1, 2), 0, 0.025, 0.015), (0, -0.9 * length, 0.05)),
    ]
    if rng.random() < 0.5:
        for x in span * np.array([0.35, 0.65][: rng.integers(1, 3)]):
            y, z = -sweep * 0.8 * x / span + 0.2, level - 0.09 + x * np.tan(np.radians(rise))
            parts.append(cylinder((x, y - 0.2, z), (x, y + 0.15, z), 0.08, 0.03))
    else:
        nose = 0.6 * length + body
        parts.append(frustum((0, nose - 0.05, 0), (0, nose + 0.12, 0), 0.07, 0.02))
        parts.append(plate(np.array([[0, 0.05], [0.3, 0.03], [0.3, -0.03], [0, -0.05]]), (0, 2), nose, 0.02, 0.01))
        parts.append(capsule((0.2, 0.2, level), (0.25, 0.25, -0.35), 0.03))
        parts.append(torus((0.25, 0.25, -0.35), (1, 0, 0), 0.06, 0.04))
    return mirrored(union(*parts, blend=0.03))


def boat(rng: np.random.Generator) -> Solid:
    """Boat: an open or decked hull, with a cabin and a funnel or with a mast and a sail."""
    length, w, depth = rng.uniform(0.9, 1.4), rng.uniform(0.28, 0.5), rng.uniform(0.3, 0.5)
    sheer = 1.25 * depth
    shell = intersection(
        ellipsoid((0, 0, sheer), (w, length, sheer + depth)),
        halfspace((0, -0.12, 1), 0.12),
        halfspace((0, -1, -0.15), rng.uniform(0.55, 0.8) * length),
    )
    hold = intersection(
        ellipsoid((0, 0, sheer), (w - 0.06, length - 0.12, sheer + depth - 0.08)),
        halfspace((0, -1, -0.15), 0.5 * length),
    )
    sunk = translate(hold, (0, 0, 0.0 if rng.random() < 0.5 else 0.6 * depth))
    keel = [[0.1, -0.98], [-0.3, -0.86], [-0.62, -0.5], [-0.66, -1.05]]
    parts = [difference(shell, sunk), plate(np.array(keel) * [length, depth], (1, 2), 0, 0.03)]
    if rng.random() < 0.5:
        top = rng.uniform(0.25, 0.5)
        parts += [
            box((0, -0.2, top / 2 - 0.1), (0.55 * w, 0.3 * length, top / 2 + 0.1), 0.03),
            box((0, 0.05, top), (0.4 * w, 0.12 * length, 0.2), 0.03),
            cylinder((0, -0.35, top), (0, -0.4, top + rng.uniform(0.2, 0.5)), 0.1, 0.02),
        ]
    else:
        mast = rng.uniform(1.0, 1.6)
        parts += [
            capsule((0, 0.2, -depth + 0.1), (0, 0.15, mast), 0.04, 0.025),
            capsule((0, 0.2, 0.3), (0, -0.65 * length, 0.35), 0.03),
            capsule((0, 0.95 * length, 0.15), (0, 0.15, mast), 0.02),
            box((0, -0.25, -0.02), (0.8 * w, 0.08, 0.025), 0.01),
            plate(np.array([[0.14, 0.4], [-0.55 * length, 0.42], [0.12, mast - 0.1]]), (1, 2), 0, 0.02),
        ]
    return mirrored(*parts)


def bicycle(rng: np.random.Generator) -> Solid:
    """Balance bicycle, thinnest along its normal: two wheels with spokes, frame, fork, handlebar, saddle."""
    wheel, base = rng.uniform(0.35, 0.5), rng.uniform(0.55, 0.75)
    front = wheel * rng.uniform(0.8, 1.1)
    r = rng.uniform(0.03, 0.045)
    rear_hub, front_hub = np.array([0, -base, 0]), np.array([0, base, front - wheel])
    crank = np.array([0, -0.1, -0.05])
    saddle = np.array([0, -0.3, rng.uniform(0.5, 0.75)])
    head = front_hub + [0, -0.25, rng.uniform(0.55, 0.8)]
    bar = rng.uniform(0.2, 0.4)
    parts: list[Field] = [
        tube(np.array([rear_hub + [0.06, 0, 0], crank, saddle, rear_hub + [0.06, 0, 0]]), r * 0.8),
        tube(np.array([crank, head - [0, 0, 0.12], saddle - [0, 0, 0.1]]), r),
        tube(np.array([front_hub + [0.07, 0, 0], front_hub + [0.07, -0.1, 0.35], head]), r),
        capsule(head, head + [0, -0.03, 0.12], r),
        tube(np.array([head + [0, -0.03, 0.12], head + [bar, -0.08, 0.14], head + [bar, -0.25, 0.12]]), 0.03),
        ellipsoid(saddle + [0, -0.02, 0.06], (0.12, 0.15, 0.06)),
        ellipsoid(saddle + [0, 0.14, 0.06], (0.05, 0.14, 0.04)),
        capsule(crank, crank + [0.16, 0, 0], 0.05),
    ]
    for hub, radius in ((rear_hub, wheel), (front_hub, front)):
        parts += [torus(hub, (1, 0, 0), radius - 0.035, 0.035), capsule(hub, hub + [0.07, 0, 0], 0.035)]
        for angle in 2 * np.pi * np.arange(6) / 6:
            rim = hub + (radius - 0.03) * np.array([0, np.cos(angle), np.sin(angle)])
            parts.append(capsule(hub, rim, 0.015))
    return mirrored(*parts)
