"""A demonstration on a scan made here: nothing is downloaded, and the true plane is known."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax import datasets
from symjax.detection import summary
from symjax.detection.detect import detect
from symjax.detection.result import Detection
from symjax.geometry import distance
from symjax.geometry.plane import Plane
from symjax.viz.html import write_html
from symjax.viz.png import write_png

KIND = "quadruped"
NUM_POINTS = 6000
MISSING = 0.25
"""Share of the surface that the scan lacks, one connected part."""
NOISE = 0.002
"""Standard deviation of the noise in each coordinate, as a fraction of the diagonal."""
OUTLIERS = 0.5
"""Stray points in the scan's box per point of the scan."""
FILES = ("demo.html", "demo.png")


class Scan(NamedTuple):
    """A partial, noisy cloud and the mirror plane of the object that it was taken from."""

    points: Float[np.ndarray, "n 3"]
    truth: Plane
    up: Float[np.ndarray, "3"]
    """The object's upright direction: a random pose has none, and a picture should."""


def make_scan(seed: int) -> Scan:
    """A random object in a random pose, with a part missing, noise and stray points; its seed repeats it."""
    rng = np.random.default_rng(seed)
    upright = datasets.generate(KIND, num_points=NUM_POINTS, rng=rng)
    whole = datasets.pose(upright, rng)
    corrupted = datasets.corrupt(whole.points, rng, missing=MISSING, noise=NOISE, outliers=OUTLIERS)
    truth = Plane(whole.normals[0], whole.offsets[0])
    before, after = (points - points.mean(axis=0) for points in (upright.points, whole.points))
    up = np.linalg.lstsq(before, after)[0][2]
    return Scan(corrupted.points, truth, up)


def run(folder: Path, *, seed: int, progress: Callable[[str], None]) -> list[str]:
    """Make the scan, find its plane, and write demo.html and demo.png into a folder.

    Args:
        folder: an existing folder.
        seed: of the object, its scan and the detection.
        progress: called with the name of every stage as it begins.

    Returns:
        What to tell a person, line by line.
    """
    start = perf_counter()
    progress("making a scan")
    scan = make_scan(seed)
    detection = detect(scan.points, rng=seed, progress=progress)
    page, picture = (folder / name for name in FILES)
    progress(f"writing {page}")
    write_html(detection, page, up=scan.up)
    progress(f"writing {picture}")
    write_png(detection, picture, up=scan.up)
    return [
        f"A {KIND} of {NUM_POINTS} points: {MISSING:.0%} of it missing, noise {NOISE:.1%} of its size, and a stray "
        f"point for every {1 / OUTLIERS:.0f} of the rest; seed {seed}.",
        *summary.lines(detection),
        _comparison(detection, scan),
        f"Written in {perf_counter() - start:.1f} s in all: {page} (interactive, open it in a browser), {picture}",
    ]


def _comparison(detection: Detection, scan: Scan) -> str:
    angle = float(distance.deviation_angle(detection.plane.normal, scan.truth.normal))
    offset = float(distance.offset_error(detection.plane, scan.truth, scan.points.mean(axis=0), detection.diagonal))
    return f"{'error':<10}{angle:.2f} degrees and {offset:.2%} of the diagonal from the true plane"
