"""The objects of a benchmark by name and number, each with a dense sample of its whole surface.

`procedural` is the generated benchmark. Of the others, which are read from a folder, the numbers count what their
loader gives.
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
"""Points of the dense sample: what `metrics.sde.cloud_sde` asks for."""

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
"""What tables call those whose name does not say it."""


class BenchmarkObject(NamedTuple):
    """An object that methods are evaluated on.

    Attributes:
        case: posed and whole, with the planes that are right.
        dense: another sample of the same surface, none of it among the points of the case; empty where the benchmark is
            of clouds with no more points.
        truths: rectangles of the right planes, where the benchmark publishes them.
    """

    case: Case
    dense: Float[np.ndarray, "m 3"]
    truths: Patches | None = None


def _shapes(benchmark: str, data: str) -> Iterator[Shape]:
    return LOADERS[benchmark](MODELS if benchmark == REAL else Path(data))


class _Shelf:
    """The shapes of a loader, walked forwards: tasks ask for them in rising order, and reading one takes a while."""

    def __init__(self, benchmark: str, data: str) -> None:
        self._load = lambda: _shapes(benchmark, data)
        self._shapes, self._next = self._load(), 0

    def shape(self, item: int) -> Shape:
        if item < self._next:
            self._shapes, self._next = self._load(), 0
        shape = next(islice(self._shapes, item - self._next, None))
        self._next = item + 1
        return shape


_shelf = lru_cache(maxsize=1)(_Shelf)


def items(benchmark: str, data: str, most: int) -> dict[int, str]:
    """Numbers and names of the first objects that have planes and no axis.

    Of an object with an axis all planes through it are right: measures that count truths say nothing of it. The
    number of skipped objects is printed to stderr, and so is it if there are none, or the real models are absent.

    Raises:
        DataAbsentError: another benchmark is not in its folder.
        FileFormatError: a file is malformed.
    """
    if benchmark == PROCEDURAL:
        return {k: procedural.kind(k) for k in range(min(most, procedural.NUM_OBJECTS))}
    usable: dict[int, str] = {}
    seen = 0
    try:
        # one at a time: a benchmark of meshes may not fit into memory
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
        print(f"{benchmark}: {without} OF {seen} OBJECTS HAVE NO PLANES OR AN AXIS: left out", file=sys.stderr)
    return usable


@lru_cache(maxsize=2)
def benchmark_object(benchmark: str, data: str, item: int, seed: int, num_points: int) -> BenchmarkObject:
    """An object of a benchmark.

    Args:
        benchmark: one of `NAMES`.
        data: its folder; empty for `procedural` and `real`, which have theirs.
        item: its number.
        seed: of pose and points; of `procedural`, other seeds have other individuals of the same kinds.
        num_points: points of the case.
    """
    drawn = num_points + DENSE
    truths = None
    if benchmark == PROCEDURAL:
        whole = procedural.generated_object(item, drawn, seed=procedural.SEED + seed)
    else:
        shape = _shelf(benchmark, data).shape(item)
        whole, corners = shape.case(drawn, seed), shape.posed(seed).corners
        truths = None if corners is None else from_corners(corners)
    return BenchmarkObject(whole._replace(points=whole.points[:num_points]), whole.points[num_points:], truths)
