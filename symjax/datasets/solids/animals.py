"""Animals with one mirror plane, x = 0. y points forward and z up; joints are filleted."""

import numpy as np

from symjax.datasets.solids.csg import rotate, translate, union
from symjax.datasets.solids.primitives import Field, capsule, ellipsoid, plate, sphere, tube
from symjax.datasets.solids.solid import Solid, mirrored


def quadruped(rng: np.random.Generator) -> Solid:
    """Four-legged animal, from dachshund to giraffe: trunk, legs, neck, tail, and a head with ears, some with horns."""
    return mirrored(torso_and_legs(rng), head_and_neck(rng), blend=0.06)


def torso_and_legs(rng: np.random.Generator, stride: float = 0.0, swing: float = 0.0) -> Field:
    """Makes the trunk, the tail and the legs of the right side.

    `stride` moves the front foot forward and the hind foot back; `swing` moves the end of the tail to the right.
    """
    w, length, h = rng.uniform(0.16, 0.3), rng.uniform(0.4, 0.75), rng.uniform(0.3, 0.9)
    r, hoof = rng.uniform(0.05, 0.09), rng.uniform(0.06, 0.1)
    x = 0.7 * w
    parts = [
        ellipsoid((0, 0.45 * length, 0), (w, 0.5 * length, 1.15 * w)),
        ellipsoid((0, -0.4 * length, 0.02), (1.05 * w, 0.55 * length, w)),
    ]
    for y, step, bend in ((0.6 * length, stride, 0.03), (-0.65 * length, -stride, -0.08)):
        knee, foot = np.array([x, y + bend + step / 2, -0.5 * h]), np.array([x, y + step, -h])
        parts.append(tube(np.array([[x, y, -0.05], knee, foot]), np.array([1.5 * r, r, 0.8 * r])))
        parts.append(ellipsoid(foot + [0, 0.04, -0.02], (hoof, 1.4 * hoof, 0.05)))
    droop, tail = rng.uniform(-0.5, 0.4), rng.uniform(0.3, 0.6)
    rump = np.array([0, -0.85 * length, 0.5 * w])
    ends = rump + tail * np.array([[0, 0, 0], [0, -0.5, 0.15], [0, -0.9, 0.3 + droop]])
    ends[:, 0] = swing * np.array([0, 0.5, 1])
    parts.append(tube(ends, np.array([0.06, 0.045, 0.03])))
    return union(*parts, blend=0.06)


def head_and_neck(rng: np.random.Generator) -> Field:
    """Makes the neck, the skull, the snout, and the ear, eye and (sometimes) horn of the right side."""
    chest = np.array([0, 0.5, 0.1])
    neck, pitch = rng.uniform(0.25, 0.8), np.radians(rng.uniform(25, 75))
    top = chest + neck * np.array([0, np.cos(pitch), np.sin(pitch)])
    snout, skull = rng.uniform(0.15, 0.35), rng.uniform(0.13, 0.19)
    ear, spread = rng.uniform(0.12, 0.4), rng.uniform(0.1, 0.3)
    head = [
        ellipsoid(top, (skull * 0.9, skull * 1.1, skull)),
        capsule(top, top + [0, snout + 0.1, -0.4 * snout], 0.75 * skull, 0.45 * skull),
        ellipsoid(top + [0.4 * skull + spread / 3, -0.05, 0.7 * skull + ear / 3], (0.05 + spread / 3, 0.035, ear / 2)),
        sphere(top + [0.7 * skull, 0.6 * skull, 0.4 * skull], 0.05),
    ]
    if rng.random() < 0.4:
        horns = top + np.array([[0.05, 0, 0.1], [0.15, 0, 0.25], [0.2, -0.05, 0.45]])
        head.append(tube(horns, np.array([0.05, 0.04, 0.025])))
    return union(capsule(chest, top, 0.16, 0.1), union(*head, blend=0.04), blend=0.05)


def fish(rng: np.random.Generator) -> Solid:
    """Fish, thinnest along its normal: body, forked tail, dorsal, ventral and pectoral fins, eyes."""
    w, length, h = rng.uniform(0.12, 0.26), rng.uniform(0.7, 1.0), rng.uniform(0.25, 0.5)
    tail = rng.uniform(0.25, 0.5)
    caudal = np.array([[0.1, 0], [-0.3, tail], [-0.18, 0], [-0.3, -tail * rng.uniform(0.5, 1)]])
    start = rng.uniform(-0.1, 0.4) * length
    dorsal = np.array([[start, 0.4 * h], [-0.5 * length, 0.2 * h], [start - 0.35, h + rng.uniform(0.1, 0.35)]])
    belly = np.array([[0.1, -0.5 * h], [-0.35, -0.5 * h], [-0.3, -h - 0.15]])
    breast = np.array([[0, 0.12], [0.0, -0.08], [0.3, -0.22], [0.35, -0.1]]) * rng.uniform(0.8, 1.5)
    wing = translate(plate(breast, (0, 1), 0, 0.025, 0.01), (0.6 * w, 0.35 * length, -0.25 * h))
    parts = [
        union(
            ellipsoid((0, 0.4 * length, -0.05), (w, 0.65 * length, h)),
            ellipsoid((0, -0.3 * length, 0), (0.75 * w, 0.7 * length, 0.5 * h)),
            blend=0.15,
        ),
        capsule((0, -0.4, 0), (0, -length - 0.05, 0), 0.6 * w, 0.05),
        translate(plate(caudal, (1, 2), 0, 0.025, 0.01), (0, -length - 0.05, 0)),
        plate(dorsal, (1, 2), 0, 0.025, 0.01),
        plate(belly, (1, 2), 0, 0.025, 0.01),
        rotate(wing, 1, rng.uniform(10, 50), (0.6 * w, 0, -0.25 * h)),
        sphere((0.55 * w, 0.75 * length, 0.15 * h), 0.07),
    ]
    return mirrored(union(*parts, blend=0.03))


def bird(rng: np.random.Generator) -> Solid:
    """Bird in flight, widest along its normal: body, head, beak, spread wings, tail fan, feet."""
    span, length = rng.uniform(0.8, 1.4), rng.uniform(0.35, 0.6)
    body, chord = rng.uniform(0.13, 0.22), rng.uniform(0.18, 0.32)
    bend, sweep = rng.uniform(0.3, 0.55) * span, rng.uniform(0.1, 0.6)
    wing = np.array(
        [[0, chord], [bend, chord + 0.12], [span, -sweep], [0.9 * span, -sweep - 0.12], [bend, -chord], [0, -chord]]
    )
    fan = np.array([[0.03, 0], [rng.uniform(0.12, 0.3), -0.4], [0.0, -0.45], [-0.2, -0.4], [-0.03, 0]])
    neck = np.array([0, length + rng.uniform(0.0, 0.3), rng.uniform(0.02, 0.2)])
    parts = [
        ellipsoid((0, 0, 0), (body, length, 1.1 * body)),
        capsule((0, 0.6 * length, 0), neck, 0.8 * body, 0.08),
        sphere(neck, 0.12),
        capsule(neck + [0, 0.05, 0], neck + [0, 0.15 + rng.uniform(0.05, 0.25), -0.05], 0.06, 0.02),
        rotate(plate(wing, (0, 1), 0.05, 0.028, 0.015), 1, rng.uniform(-25, 10), (0, 0, 0.05)),
        translate(plate(fan, (0, 1), 0, 0.025, 0.015), (0, -0.85 * length, 0)),
        tube(np.array([[0.07, -0.1, -0.1], [0.08, -0.2, -0.2 - body], [0.09, -0.35, -0.2 - body]]), 0.025),
    ]
    return mirrored(union(*parts, blend=0.03))


def insect(rng: np.random.Generator) -> Solid:
    """Insect: head, thorax, abdomen, eyes, feelers, six bent legs, with or without wings."""
    abdomen, w = rng.uniform(0.3, 0.6), rng.uniform(0.15, 0.3)
    reach, knee = rng.uniform(0.5, 0.9), rng.uniform(0.1, 0.45)
    skull = rng.uniform(0.1, 0.18)
    front = 0.22 + skull
    parts = [
        ellipsoid((0, 0, 0), (0.15, 0.22, 0.14)),
        ellipsoid((0, -0.15 - abdomen, 0.03), (w, abdomen, 0.75 * w)),
        ellipsoid((0, front, 0.02), (1.2 * skull, skull, skull)),
        sphere((0.8 * skull, front + 0.4 * skull, 0.6 * skull), 0.055),
        tube(np.array([[0.05, front, 0.08], [0.15, front + 0.25, 0.3], [0.28, front + 0.5, 0.25]]), 0.022),
    ]
    for y, ahead in ((0.14, 0.4), (0.0, -0.05), (-0.12, -0.5)):
        joints = [[0.1, y, -0.02], [0.55 * reach, y + 0.6 * ahead, knee], [reach, y + ahead, -0.35]]
        parts.append(tube(np.array(joints), np.array([0.035, 0.03, 0.025])))
    if rng.random() < 0.5:
        length = rng.uniform(0.6, 1.1)
        wing = ellipsoid((0.08, -length / 2, 0), (0.16, length / 2, 0.025))
        spread = rotate(wing, 2, rng.uniform(10, 75))
        parts.append(translate(rotate(spread, 1, -rng.uniform(5, 30)), (0.06, 0, 0.13)))
    return mirrored(union(*parts, blend=0.03))
