"""Furniture with one mirror plane, x = 0. y points to the front and z up; lengths are about 1."""

import numpy as np

from symjax.datasets.solids.csg import difference, rotate, union
from symjax.datasets.solids.primitives import Field, box, capsule, cylinder, frustum, sphere, torus, tube
from symjax.datasets.solids.solid import Solid, mirrored


def chair(rng: np.random.Generator) -> Solid:
    """Chair: four legs, a back made of slats or of one panel, with or without armrests."""
    w, d, h = rng.uniform(0.3, 0.6), rng.uniform(0.3, 0.55), rng.uniform(0.4, 0.9)
    back, lean = rng.uniform(0.5, 1.2), rng.uniform(2, 16)
    thick, splay = rng.uniform(0.03, 0.06), rng.uniform(0, 0.15)
    r = rng.uniform(0.03, 0.05)
    parts = [box((0, 0, 0), (w, d, thick), 0.03)]
    for y in (-d + 0.06, d - 0.06):
        parts.append(capsule((w - 0.06, y, 0), (w - 0.06 + splay, y + splay * np.sign(y), -h), r, 0.8 * r))
    rest: list[Field] = [capsule((w - r, -d + r, 0), (w - r, -d + r, back), r)]
    if rng.random() < 0.5:
        rest += [box((0, -d + r, z * back), (w - r, 0.025, 0.07 * back), 0.02) for z in (0.35, 0.65, 0.95)]
    else:
        bottom = rng.uniform(0.05, 0.5) * back
        rest.append(box((0, -d + r, (bottom + back) / 2), (w - r, 0.03, (back - bottom) / 2), 0.03))
    parts += [rotate(part, 0, lean, about=(0, -d, 0)) for part in rest]
    if rng.random() < 0.5:
        level = rng.uniform(0.3, 0.45)
        parts += [
            box((w, -0.1, level), (0.05, d, 0.03), 0.02),
            capsule((w, d - 0.15, 0), (w, d - 0.15, level), 0.035),
        ]
    return mirrored(*parts)


def sofa(rng: np.random.Generator) -> Solid:
    """Sofa: base, back, armrests, two or three seat cushions, feet."""
    w, d, h = rng.uniform(0.7, 1.4), rng.uniform(0.35, 0.6), rng.uniform(0.12, 0.22)
    back, arm = rng.uniform(0.35, 0.8), rng.uniform(0.2, 0.4)
    width = rng.uniform(0.08, 0.18)
    parts = [
        box((0, 0, 0), (w, d, h), 0.04),
        rotate(box((0, -d + 0.1, back / 2), (w, 0.1, back / 2 + h), 0.08), 0, rng.uniform(0, 12), (0, -d, 0)),
        box((w - width / 2, 0, arm / 2), (width, d, arm / 2 + h), min(0.06, width / 2)),
        frustum((w - 0.1, d - 0.1, -h), (w - 0.1, d - 0.1, -h - 0.15), 0.05, 0.03),
        frustum((w - 0.1, -d + 0.1, -h), (w - 0.1, -d + 0.1, -h - 0.15), 0.05, 0.03),
    ]
    count = rng.integers(2, 4)
    half = (w - width) / count
    for x in half * np.arange(1 - count % 2, count, 2):
        parts.append(box((x, 0.12, h + 0.06), (half - 0.01, d - 0.1, 0.09), 0.06))
    return mirrored(*parts)


def desk(rng: np.random.Generator) -> Solid:
    """Desk: a top, side panels or four legs, a shallow back panel, a drawer with a knob, with or without a shelf."""
    w, d, h = rng.uniform(0.6, 1.2), rng.uniform(0.3, 0.6), rng.uniform(0.4, 0.8)
    parts = [box((0, 0, 0), (w, d, 0.035), 0.015)]
    if rng.random() < 0.5:
        parts.append(box((w - 0.08, 0, -h / 2), (0.03, d - 0.05, h / 2), 0.01))
    else:
        for y in (-d + 0.08, d - 0.08):
            parts.append(frustum((w - 0.08, y, 0), (w - 0.08, y, -h), 0.05, 0.03))
    drop, width = rng.uniform(0.1, 0.2), rng.uniform(0.25, 0.5)
    rail = rng.uniform(0.15, 0.4)
    parts += [
        box((0, -d + 0.08, -rail / 2), (w - 0.08, 0.025, rail / 2), 0.01),
        box((0, d - 0.25, -drop / 2 - 0.01), (width, 0.22, drop / 2 + 0.02), 0.01),
        sphere((0, d + 0.02, -drop / 2 - 0.01), 0.04),
    ]
    if rng.random() < 0.6:
        shelf = rng.uniform(0.2, 0.5)
        parts += [
            box((0, -d + 0.12, shelf), (w, 0.12, 0.025), 0.01),
            box((w - 0.03, -d + 0.12, shelf / 2), (0.03, 0.12, shelf / 2), 0.01),
        ]
    return mirrored(*parts)


def lamp(rng: np.random.Generator) -> Solid:
    """Desk lamp: a foot, an arm of two links in the mirror plane, a tilted shade with a bulb."""
    foot = rng.uniform(0.25, 0.5)
    lower, upper = rng.uniform(0.5, 0.9), rng.uniform(0.4, 0.8)
    elbow = np.array([0, -rng.uniform(0.1, 0.4), lower])
    reach = np.radians(rng.uniform(10, 50))
    head = elbow + upper * np.array([0, np.cos(reach), np.sin(reach)])
    down = np.radians(rng.uniform(30, 80))
    aim = np.array([0, np.cos(down), -np.sin(down)])
    shade, mouth = rng.uniform(0.25, 0.45), rng.uniform(0.18, 0.35)
    hollow = frustum(head + 0.06 * aim, head + (shade + 0.05) * aim, 0.06, mouth - 0.02)
    parts = [
        cylinder((0, 0, -0.04), (0, 0, 0.04), foot, 0.02),
        tube(np.array([[0, 0, 0], elbow, head]), 0.035),
        sphere(elbow, 0.07),
        capsule((0.05, elbow[1], elbow[2]), (0.12, elbow[1], elbow[2]), 0.035),
        difference(frustum(head - 0.04 * aim, head + shade * aim, 0.1, mouth + 0.02), hollow),
        sphere(head + 0.5 * shade * aim, 0.07),
        capsule(head, head + 0.5 * shade * aim, 0.04),
        sphere((0, 0.6 * foot, 0.04), 0.05),
    ]
    return mirrored(*parts)


def wheelchair(rng: np.random.Generator) -> Solid:
    """Wheelchair: two large wheels, two castors, seat, back, armrests, handles, footrests."""
    w, d = rng.uniform(0.22, 0.4), rng.uniform(0.25, 0.4)
    wheel, small = rng.uniform(0.35, 0.5), rng.uniform(0.12, 0.2)
    back = rng.uniform(0.45, 0.8)
    axle = (w + 0.08, -d + 0.1, wheel - 0.5)
    caster = (w, d + 0.05, small - 0.5)
    parts = [
        torus(axle, (1, 0, 0), wheel - 0.03, 0.03),
        *_spokes(axle, wheel - 0.03, int(rng.integers(4, 8))),
        cylinder((w, *axle[1:]), (w + 0.11, *axle[1:]), 0.05),
        cylinder((w - 0.03, *caster[1:]), (w + 0.03, *caster[1:]), small, 0.02),
        capsule((w, d + 0.02, caster[2]), (w, d - 0.05, 0), 0.03),
        box((0, 0, 0), (w, d, 0.04), 0.03),
        box((0, -d, back / 2), (w, 0.03, back / 2), 0.02),
        capsule((w - 0.03, -d, back), (w - 0.03, -d - 0.18, back), 0.035),
        tube(np.array([[w, d, 0], [w, d - 0.05, 0.25], [w, -d, 0.25]]), 0.035),
        tube(np.array([[w - 0.05, d, 0], [w - 0.05, d + 0.2, -0.35]]), 0.03),
        box((w / 2, d + 0.25, -0.36), (w / 2 - 0.02, 0.1, 0.025), 0.01),
    ]
    return mirrored(union(*parts))


def _spokes(axle: tuple[float, float, float], radius: float, count: int) -> list[Field]:
    angles = 2 * np.pi * np.arange(count) / count
    rims = [(axle[0], axle[1] + radius * np.cos(a), axle[2] + radius * np.sin(a)) for a in angles]
    return [capsule(axle, rim, 0.02) for rim in rims]
