"""Vessels, tools and instruments with one mirror plane, x = 0."""

import numpy as np

from symjax.datasets.solids.csg import difference, rotate, translate, union
from symjax.datasets.solids.primitives import (
    Field,
    arc,
    box,
    capsule,
    cylinder,
    ellipsoid,
    frustum,
    lathe,
    plate,
    sphere,
    tube,
)
from symjax.datasets.solids.solid import Solid, mirrored

UP, AHEAD = (0, 0, 1), (0, 1, 0)


def mug(rng: np.random.Generator) -> Solid:
    """Mug: a handle, a pouring lip opposite it, and a pair of raised dots."""
    r, h, flare = rng.uniform(0.35, 0.55), rng.uniform(0.4, 0.7), rng.uniform(0.85, 1.15)
    wall = rng.uniform(0.05, 0.08)
    hollow = frustum((0, 0, -h + 0.1), (0, 0, h + 0.1), r - wall, r * flare - wall)
    grip, size = rng.uniform(0.06, 0.09), rng.uniform(0.65, 0.85) * h
    middle = r * (1 + flare) / 2
    body = union(
        frustum((0, 0, -h), (0, 0, h), r, r * flare),
        arc((0, -middle + 0.02, 0), (0, -1, 0), UP, size, grip, np.radians(95)),
        blend=0.04,
    )
    lip = ellipsoid((0, r * flare, h), (0.12, 0.18, 0.12))
    angle, level = np.radians(rng.uniform(35, 80)), rng.uniform(-0.4, 0.3) * h
    dot = (middle * np.sin(angle), middle * np.cos(angle), level)
    return mirrored(difference(union(body, lip, sphere(dot, 0.13), blend=0.02), hollow))


def teapot(rng: np.random.Generator) -> Solid:
    """Teapot: a belly, a spout, a lid with a knob, and a handle at the back or over the lid."""
    r, squash = rng.uniform(0.5, 0.75), rng.uniform(0.65, 1.1)
    h = r * squash
    spout, rise = rng.uniform(0.35, 0.6), rng.uniform(0.2, 0.5)
    root = np.array([0, 0.8 * r, -0.2 * h])
    way = root + np.array(
        [[0, 0, 0], [0, 0.6 * spout, 0.3 * rise], [0, 0.75 * spout, 0.9 * rise], [0, spout, 1.2 * rise]]
    )
    parts = [
        ellipsoid((0, 0, 0), (r, r, h)),
        cylinder((0, 0, -h), (0, 0, -0.8 * h), 0.6 * r, 0.02),
        tube(way, np.array([0.14, 0.1, 0.075, 0.06])),
        ellipsoid((0, 0, 0.93 * h), (0.45 * r, 0.45 * r, 0.15)),
        sphere((0, 0, h + 0.15), rng.uniform(0.07, 0.12)),
    ]
    if rng.random() < 0.6:
        size = rng.uniform(0.5, 0.75) * h
        parts.append(arc((0, -0.85 * r, 0.05), (0, -1, 0), UP, size, 0.06, np.radians(110)))
    else:
        parts.append(arc((0, 0, 0.6 * h), UP, AHEAD, 0.85 * r, 0.05, np.radians(95)))
    return mirrored(union(*parts, blend=0.04))


def watering_can(rng: np.random.Generator) -> Solid:
    """Watering can: an open drum, a long spout with a rose, a handle at the back, a brace."""
    r, h = rng.uniform(0.35, 0.5), rng.uniform(0.3, 0.55)
    reach, rise = rng.uniform(0.6, 1.0), rng.uniform(0.1, 0.6)
    root = np.array([0, 0.9 * r, -0.6 * h])
    tip = np.array([0, r + reach, h + rise])
    aim = (tip - root) / np.linalg.norm(tip - root)
    drum = difference(cylinder((0, 0, -h), (0, 0, h), r, 0.03), cylinder((0, 0, -h + 0.08), (0, 0, h + 0.1), r - 0.06))
    parts = [
        drum,
        capsule(root, tip, 0.1, 0.06),
        frustum(tip, tip + 0.15 * aim, 0.06, rng.uniform(0.14, 0.22)),
        arc((0, -r, 0.1), (0, -1, 0), UP, rng.uniform(0.3, 0.45), 0.045, np.radians(110)),
        capsule((0, r, 0.8 * h), root + 0.75 * (tip - root), 0.025),
        box((0, 0.55 * r, h - 0.02), (0.8 * r, 0.03, 0.03), 0.01),
    ]
    return mirrored(union(*parts, blend=0.02))


def hammer(rng: np.random.Generator) -> Solid:
    """Claw hammer, thinnest along its normal: handle, face, forked and curved claw."""
    length, grip = rng.uniform(1.1, 1.8), rng.uniform(0.07, 0.11)
    face, neck = rng.uniform(0.12, 0.19), rng.uniform(0.2, 0.35)
    top = np.array([0, 0, length / 2])
    bend = rng.uniform(0.1, 0.35)
    claw = top + np.array([[0.04, -0.1, 0], [0.07, -0.3, -0.3 * bend], [0.1, -0.5, -bend]])
    parts = [
        capsule((0, 0, -length / 2), (0, 0.02, -0.1), grip, 0.75 * grip),
        capsule((0, 0.02, -0.1), top, 0.75 * grip, 0.6 * grip),
        box(top, (0.11, 0.14, 0.12), 0.04),
        cylinder(top, top + [0, neck, 0], 0.75 * face, 0.02),
        cylinder(top + [0, neck, 0], top + [0, neck + 0.14, 0], face, 0.03),
        tube(claw, np.array([0.1, 0.07, 0.03])),
    ]
    return mirrored(union(*parts, blend=0.03))


def guitar(rng: np.random.Generator) -> Solid:
    """Guitar: a waisted body with a sound hole, a bridge, a neck, and a head with pegs."""
    lower, upper = rng.uniform(0.4, 0.55), rng.uniform(0.28, 0.42)
    depth, neck = rng.uniform(0.09, 0.16), rng.uniform(0.7, 1.1)
    waist = lower + upper - rng.uniform(0.1, 0.25)
    top = waist + upper
    hollow = cylinder((0, waist - 0.1, -depth + 0.04), (0, waist - 0.1, 0.5), rng.uniform(0.12, 0.17))
    flat_body = union(
        cylinder((0, 0, -depth), (0, 0, depth), lower, 0.03),
        cylinder((0, waist, -depth), (0, waist, depth), upper, 0.03),
        blend=0.2,
    )
    head = top + neck
    parts: list[Field] = [
        difference(flat_body, hollow),
        box((0, top + neck / 2 - 0.1, depth), (0.07, neck / 2 + 0.1, 0.04), 0.02),
        rotate(box((0, head + 0.13, depth), (0.11, 0.17, 0.03), 0.015), 0, -rng.uniform(5, 20), (0, head, depth)),
        box((0, -0.1, depth + 0.02), (rng.uniform(0.12, 0.22), 0.035, 0.035), 0.01),
    ]
    for y in (0.04, 0.13, 0.22):
        parts.append(capsule((0.1, head + y, depth - 0.03), (0.2, head + y, depth - 0.03), 0.03))
    return mirrored(translate(union(*parts), (0, -0.5 * head, 0)))


def coat_hook(rng: np.random.Generator) -> Solid:
    """Wall hook: a plate, a large hook above, and a pair of small hooks below."""
    w, h = rng.uniform(0.2, 0.4), rng.uniform(0.4, 0.7)
    shield = np.array([[w, 0.8 * h], [0.7 * w, h], [-0.7 * w, h], [-w, 0.8 * h], [-0.6 * w, -h], [0.6 * w, -h]])
    reach, aside = rng.uniform(0.3, 0.6), rng.uniform(0.15, 0.45)
    high = np.array([[0, 0, 0.3 * h], [0, 0.7 * reach, 0.2 * h], [0, reach, 0.45 * h], [0, 0.95 * reach, 0.9 * h]])
    low = np.array([[0, 0, -0.5 * h], [0.6 * aside, 0.2, -0.6 * h], [aside, 0.32, -0.35 * h], [aside, 0.32, -0.1 * h]])
    parts = [
        plate(shield, (0, 2), 0, 0.05, 0.02),
        tube(high, np.array([0.1, 0.08, 0.07, 0.06])),
        sphere(high[-1], rng.uniform(0.08, 0.12)),
        tube(low, np.array([0.08, 0.06, 0.05, 0.05])),
        sphere(low[-1], rng.uniform(0.06, 0.1)),
    ]
    return mirrored(union(*parts, blend=0.03))


def jug(rng: np.random.Generator) -> Solid:
    """Jug: a round body with a long neck, a beak and a high handle."""
    belly, h = rng.uniform(0.35, 0.55), rng.uniform(0.6, 0.9)
    neck, mouth = rng.uniform(0.14, 0.25), rng.uniform(0.2, 0.35)
    heights = np.array([-1, -0.6, -0.1, 0.3, 0.65, 0.85, 1.0]) * h
    outer = np.array([0.6 * belly, 0.95 * belly, 0.95 * belly, 0.6 * belly, neck, 1.1 * neck, mouth])
    profile = [[0.0, -h], *zip(outer, heights, strict=True), (mouth - 0.05, h), (neck - 0.05, 0.65 * h)]
    profile += [(0.8 * belly - 0.05, 0.1 * h), (0.5 * belly, -0.8 * h), (0.0, -0.85 * h)]
    beak = difference(
        capsule((0, 0.5 * mouth, 0.85 * h), (0, mouth + 0.14, h + 0.02), 0.13, 0.06),
        capsule((0, 0.0, h + 0.04), (0, mouth + 0.3, h + 0.1), 0.1, 0.05),
    )
    tall = rng.uniform(0.35, 0.5) * h
    handle = arc((0, -0.3 * belly - 0.1, 0.45 * h), (0, -1, 0), UP, tall + 0.12, 0.05, np.radians(100))
    inside = lathe(
        np.array(
            [(0.0, -0.8 * h), (neck - 0.06, 0.6 * h), (neck - 0.06, 0.7 * h), (mouth - 0.06, 1.2 * h), (0.0, 1.2 * h)]
        )
    )
    return mirrored(difference(union(lathe(np.array(profile)), beak, handle, blend=0.02), inside))
