"""People with one mirror plane, x = 0. y points forward and z up; joints are filleted."""

import numpy as np

from symjax.datasets.solids.csg import difference, union
from symjax.datasets.solids.primitives import capsule, cylinder, ellipsoid, sphere, torus, tube
from symjax.datasets.solids.solid import Solid, mirrored


def human(rng: np.random.Generator) -> Solid:
    """Human figure with a nose and feet; the arms hang or are raised, the legs are together or apart."""
    shoulder, hip = rng.uniform(0.2, 0.32), rng.uniform(0.14, 0.22)
    leg, trunk = rng.uniform(0.6, 0.95), rng.uniform(0.5, 0.7)
    limb, belly = rng.uniform(0.055, 0.085), rng.uniform(0.12, 0.24)
    skull = rng.uniform(0.12, 0.17)
    raised, apart = np.radians(rng.uniform(-70, 40)), rng.uniform(0.0, 0.25)
    ahead = rng.uniform(0.0, 0.3)
    arm = rng.uniform(0.5, 0.7)
    joint = np.array([shoulder, 0, trunk])
    elbow = joint + 0.5 * arm * np.array([np.cos(raised), -0.1, np.sin(raised)])
    hand = elbow + 0.5 * arm * np.array([np.cos(raised), ahead, np.sin(raised)])
    foot = np.array([hip / 1.6 + apart, 0, -leg])
    head = np.array([0, 0.02, trunk + 0.1 + 1.2 * skull])
    parts = [
        ellipsoid((0, 0.02, 0.3 * trunk), (0.9 * hip + 0.04, belly, 0.45 * trunk)),
        ellipsoid((0, 0, 0.75 * trunk), (shoulder, 0.14, 0.3 * trunk)),
        capsule((0, 0, trunk), head, 0.075),
        ellipsoid(head, (0.85 * skull, skull, 1.15 * skull)),
        ellipsoid(head + [0, skull, -0.02], (0.03, 0.05, 0.05)),
        tube(np.array([joint, elbow, hand]), np.array([1.1 * limb, limb, 0.7 * limb])),
        ellipsoid(hand, (0.07, 0.07, 0.07)),
        tube(
            np.array([[hip / 1.6, 0, 0.05], (foot + [hip / 1.6, 0.08, 0.05]) / 2, foot]),
            np.array([1.6, 1.2, 0.8]) * limb,
        ),
        capsule(foot, foot + [0.02, 0.16, -0.03], 0.065, 0.05),
    ]
    return mirrored(union(*parts, blend=0.05))


def head(rng: np.random.Generator) -> Solid:
    """Head on a neck: brow, eye sockets, eyes, nose, mouth, ears, chin; with or without a hat."""
    w, d, h = rng.uniform(0.5, 0.7), rng.uniform(0.6, 0.8), rng.uniform(0.7, 0.95)
    nose, ear = rng.uniform(0.1, 0.3), rng.uniform(0.12, 0.3)
    apart, level = rng.uniform(0.35, 0.5) * w, rng.uniform(0.0, 0.2)
    chin = rng.uniform(0.15, 0.35)
    face = 0.93 * d
    skull = union(
        ellipsoid((0, -0.05, 0.1), (w, d, h)),
        ellipsoid((0, 0.35 * d, -0.55 * h), (0.7 * w, 0.5 * d, chin + 0.15)),
        capsule((0, -0.15, -0.4 * h), (0, -0.25, -1.35), 0.3, rng.uniform(0.3, 0.45)),
        blend=0.15,
    )
    sockets = sphere((apart, face + 0.02, level), 0.2)
    mouth = capsule((0, face - 0.02, -0.45), (rng.uniform(0.1, 0.25), face - 0.08, -0.43), 0.06)
    carved = difference(skull, sockets, mouth, blend=0.06)
    features = [
        carved,
        sphere((apart, face - 0.14, level), 0.12),
        capsule((0, 0.85 * d, level), (0, d + nose * 0.6, -0.2), 0.06, 0.06 + 0.3 * nose),
        ellipsoid((0.98 * w, -0.05, -0.02), (0.06 + ear / 4, 0.12, ear)),
        ellipsoid((0, 0.75 * d, -0.5 * h - 0.25), (0.16, 0.16, 0.12)),
    ]
    if rng.random() < 0.3:
        features.append(cylinder((0, -0.05, 0.5 * h), (0, -0.15, 0.5 * h + rng.uniform(0.3, 0.7)), 1.02 * w))
        features.append(cylinder((0, 0.1, 0.48 * h), (0, 0.1, 0.48 * h + 0.06), 1.45 * w, 0.02))
    return mirrored(union(*features, blend=0.05))


def spectacles(rng: np.random.Generator) -> Solid:
    """Spectacles, widest along their normal: rims, bridge, nose pads, and temples that bend down behind the ears."""
    rim, gap = rng.uniform(0.3, 0.45), rng.uniform(0.08, 0.2)
    length, drop, r = rng.uniform(0.9, 1.5), rng.uniform(0.15, 0.4), rng.uniform(0.03, 0.045)
    x = rim + gap
    edge = x + rim
    hinge = np.array([edge + 0.03, -0.03, 0.1])
    tip = hinge + [0.02, -0.75 * length, 0]
    parts = [
        torus((x, 0, 0), (0, 1, 0), rim, r),
        tube(np.array([[x - rim, 0, 0.05], [0, 0.03, 0.1]]), r),
        tube(np.array([[edge - 0.02, 0, 0.1], hinge, tip, tip + [-0.03, -0.25 * length, -drop]]), r),
        tube(np.array([[x - rim, 0, -0.05], [x - rim - 0.02, -0.08, -0.1]]), 0.03),
        ellipsoid((x - rim - 0.02, -0.1, -0.12), (0.03, 0.035, 0.06)),
    ]
    return mirrored(*parts)
