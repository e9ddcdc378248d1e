"""Detections with known planes, for the tests of pictures and summaries."""

import numpy as np

from symjax.detection.result import Detection, Pairs
from symjax.geometry.plane import Plane
from symjax.method.result import Candidate


def detection_of(points, /, *, normal=(0.6, 0.0, 0.8), offset=0.3, weights=(), candidates=1, **changes):
    """Makes a detection of the plane `normal · x = offset`; pair i is point i and its mirror image."""
    points = np.asarray(points, dtype=float)
    plane = Plane(np.array(normal), np.float64(offset))
    x = points[: len(weights)]
    others = [Plane(axis, np.float64(0.1)) for axis in np.eye(3)]
    values = {
        "plane": plane,
        "found": True,
        "ambiguous": False,
        "symmetry": "one plane",
        "axis": None,
        "planes": (plane,),
        "uncertainty": None,
        "exactness": None,
        "score": 0.6,
        "threshold": 0.3,
        "candidates": tuple(Candidate(p, 0.6, 0.6) for p in [plane, *others][:candidates]),
        "pairs": Pairs(x, np.asarray(plane.reflect(x)), np.zeros((len(x), 2), int), np.array(weights, float)),
        "inlier_weight": 0.5,
        "inlier_fraction": 0.75,
        "converged": True,
        "message": "converged",
        "method": "sym-hks",
        "sigma": 0.02,
        "diagonal": 2.0,
        "seed": 0,
        "num_points": len(points),
        "used": np.arange(len(points)),
        "cleaned": False,
        "notes": (),
        "timings": {},
        "points": points,
    }
    return Detection(**values | changes)


def blob(rng, num_points=400):
    return rng.normal(size=(num_points, 3)) * (1.0, 0.6, 0.3)
