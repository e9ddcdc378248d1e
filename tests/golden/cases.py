"""The cases of the golden file: generated clouds and planted pairs, and the results for them as plain numbers.

`python -m tests.golden.cases` recomputes all results and writes `golden.json`. Run it only if results change on
purpose, in a separate commit with a table of the changes.
"""

import json
from pathlib import Path
from typing import Any

import jax
import numpy as np

import symjax
from symjax.datasets import KINDS, corrupt, generate
from symjax.datasets.planted_pairs import planted_pairs
from symjax.datasets.sample import random_orthogonal

FILE = Path(__file__).with_name("golden.json")

NUM_POINTS = 2000
SINGLE = [name for name, kind in KINDS.items() if kind.symmetry == "single"]
CLOUDS = [(kind, 0) for kind in KINDS] + [(kind, 1) for kind in SINGLE[:15]]
"""Kind and seed of 60 generated clouds."""

CONDITIONS: dict[str, dict[str, Any]] = {
    "clean": {},
    "out100": {"outliers": 1.0},
    "miss28": {"missing": 0.28},
    "noise1": {"noise": 0.01},
    "view": {"one_sided": True},
}

DETECTIONS = [(kind, seed, name, "robust") for name in CONDITIONS for kind, seed in CLOUDS] + [
    (kind, seed, "clean", "sym-hks") for kind, seed in CLOUDS
]
"""Kind, seed, condition and method."""

FITS = [
    (function, blob, outliers, seed)
    for function in ("fit_global", "sweep")
    for blob in ("isotropic", "wide")
    for outliers in (0.0, 0.4, 0.65, 0.8, 0.9)
    for seed in (0, 1)
]
"""Function, blob, fraction of outliers and seed of 40 fits."""

SIGMAS = (0.03, 0.1)


def cloud(kind: str, seed: int, condition: str) -> np.ndarray:
    """Generates an object, poses it at random and corrupts it.

    The pose is computed here and not by `pose`, to reproduce the rounding errors of the clouds that the golden file was
    made from. They decide which local optimum is found if an object has no plane, or a wrong plane that is as good.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    whole = generate(kind, num_points=NUM_POINTS, rng=rng)
    turn = random_orthogonal(rng)
    points = whole.points @ turn.T + rng.normal(size=3) * whole.diagonal
    return corrupt(points, rng, **CONDITIONS[condition]).points


def detection(kind: str, seed: int, condition: str, method: str) -> dict[str, Any]:
    """Detects the plane of a cloud, and returns the result as plain numbers."""
    det = symjax.detect(cloud(kind, seed, condition), method)
    scores = [candidate.ranking_score for candidate in det.candidates]
    return {
        "normal": det.plane.normal.tolist(),
        "offset": float(det.plane.offset),
        "score": det.score,
        "threshold": det.threshold,
        "margin": scores[0] - scores[1] if len(scores) > 1 else 1.0,
        "found": det.found,
        "ambiguous": det.ambiguous,
        "symmetry": det.symmetry,
        "planes": [[*plane.normal.tolist(), float(plane.offset)] for plane in det.planes],
        "diagonal": det.diagonal,
        "normal_error": 0.0 if det.uncertainty is None else det.uncertainty.normal_degrees,
        "offset_error": 0.0 if det.uncertainty is None else det.uncertainty.offset,
    }


def fit(function: str, blob: str, outliers: float, seed: int) -> dict[str, Any]:
    """Fits a plane to planted pairs in float64, and returns the result as plain numbers."""
    pairs = planted_pairs(np.random.default_rng(seed), 200, outliers, blob)
    with jax.enable_x64(True):
        if function == "fit_global":
            found = symjax.fit_global(pairs.x, pairs.y, 0.05)
        else:
            found = symjax.best(symjax.sweep(pairs.x, pairs.y, SIGMAS, "fibonacci", restarts=16))
        return {
            "normal": np.asarray(found.plane.normal).tolist(),
            "offset": np.asarray(found.plane.offset).tolist(),
            "loss": np.asarray(found.loss).tolist(),
            "converged": np.asarray(found.converged).tolist(),
        }


def name_of(case: tuple) -> str:
    """Returns the key of a case in the file."""
    return " ".join(str(part) for part in case)


def main() -> None:
    """Computes all results and writes the file."""
    results = {
        "detections": {name_of(case): detection(*case) for case in DETECTIONS},
        "fits": {name_of(case): fit(*case) for case in FITS},
    }
    lines = [
        f'"{group}": {{\n' + ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in of.items()) + "\n}"
        for group, of in results.items()
    ]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
