"""The objects of each benchmark by number, each with a dense sample of its whole surface.

The benchmark `procedural` is generated; the others are read from a folder, and an object's number is its position in
the order of the loader.
"""

import sys
from collections.abc import Callable, Iterator
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data import folder, funk, procedural, shapenet, shrec2016, shrec2023, ycb
from experiments.data.cases import MODELS, Case
from experiments.data.shape import Shape
from experiments.framework.absence import DataAbsentError
from experiments.metrics.patch import Patches, from_corners

DENSE = 30_000
"""Points of the dense sample: the least that `metrics.sde.cloud_sde` needs."""

PROCEDURAL, REAL = "procedural", "real"

LOADERS: dict[str, Callable[[Path], Iterator[Shape]]] = {
    REAL: folder.load,
    "folder": folder.load,
    "funk": funk.load,
    "shapenet": shapenet.load,
    "shrec2016": shrec2016.load,
    "shrec2023": shrec2023.load,
    "ycb": ycb.load,
}
"""`real` is the folder of models beside the project."""

NAMES = (PROCEDURAL, *LOADERS)

TITLES = {PROCEDURAL: procedural.NAME, REAL: "the shared real models"}
"""Titles in the tables, for benchmarks whose name is not clear by itself."""


class BenchmarkObject(NamedTuple):
    """An object on which methods are evaluated.

    Attributes:
        case: the whole object in its pose, with its true planes.
        dense: another sample of the same surface that shares no point with the case; it is shorter, or empty, if the
            benchmark consists of clouds that have no further points.
        truths: rectangles of the true planes, if the benchmark publishes them.
    """

    case: Case
    dense: Float[np.ndarray, "m 3"]
    truths: Patches | None = None


def _shapes(benchmark: str, data: str) -> Iterator[Shape]:
    return LOADERS[benchmark](MODELS if benchmark == REAL else Path(data))


class _ForwardReader:
    """Reads the shapes of a loader in order and restarts only to go back.

    Reading a shape is slow, and tasks request them in ascending order.
    """

    def __init__(self, benchmark: str, data: str) -> None:
        self._benchmark, self._data = benchmark, data
        self._restart()

    def _restart(self) -> None:
        self._shapes, self._next = _shapes(self._benchmark, self._data), 0

    def shape(self, item: int) -> Shape:
        if item < self._next:
            self._restart()
        shape = next(islice(self._shapes, item - self._next, None))
        self._next = item + 1
        return shape


@lru_cache(maxsize=1)
def _reader(benchmark: str, data: str) -> _ForwardReader:
    return _ForwardReader(benchmark, data)


def items(benchmark: str, data: str, most: int) -> dict[int, str]:
    """Returns the numbers and names of the first objects that have mirror planes and no axis.

    Every plane through an axis is a mirror plane, so measures that count true planes do not apply to objects with an
    axis. Messages to stderr give the number of skipped objects, and say if the real models are absent.

    Args:
        benchmark: one of `NAMES`.
        data: folder of the benchmark; empty for `procedural` and `real`.
        most: largest number of objects.

    Raises:
        DataAbsentError: if a benchmark other than `real` is not in its folder.
        FileFormatError: if a file is malformed.
    """
    if benchmark == PROCEDURAL:
        return {k: procedural.kind(k) for k in range(min(most, procedural.NUM_OBJECTS))}
    usable: dict[int, str] = {}
    seen = 0
    try:
        # one shape at a time: a benchmark of meshes may not fit into memory
        for shape in _shapes(benchmark, data):
            if len(usable) == most:
                break
            if shape.planes and shape.axis is None:
                usable[seen] = shape.name
            seen += 1
    except DataAbsentError as error:
        if benchmark != REAL:
            raise
        print(f"REAL MODELS ARE ABSENT: {error}\nSkipped.", file=sys.stderr)
    if len(usable) < seen:
        without = seen - len(usable)
        print(f"{benchmark}: {without} OF {seen} OBJECTS HAVE AN AXIS OR NO MIRROR PLANE. Skipped.", file=sys.stderr)
    return usable


@lru_cache(maxsize=2)
def benchmark_object(benchmark: str, data: str, item: int, seed: int, num_points: int) -> BenchmarkObject:
    """Loads or generates an object of a benchmark.

    Args:
        benchmark: one of `NAMES`.
        data: folder of the benchmark; empty for `procedural` and `real`.
        item: number of the object.
        seed: seed of the pose and the points; for `procedural` also of the object's shape within its kind.
        num_points: number of points of the case.
    """
    drawn = num_points + DENSE
    truths = None
    if benchmark == PROCEDURAL:
        whole = procedural.generated_object(item, drawn, seed=procedural.SEED + seed)
    else:
        shape = _reader(benchmark, data).shape(item)
        whole, corners = shape.case(drawn, seed), shape.posed(seed).corners
        truths = None if corners is None else from_corners(corners)
    return BenchmarkObject(whole._replace(points=whole.points[:num_points]), whole.points[num_points:], truths)
