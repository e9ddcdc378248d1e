"""Completion of objects with a missing part by the detected plane (the paper's figure of completion), and its error.

A completed cloud consists of the points and their mirror images, P ∪ Q (Sec. 5.6). The gap is the distance from the
removed points to the completed cloud, in diagonals. The added points are also measured, by their distance to another
sample of the whole object, because a wrong plane adds points off the object. Mirroring cannot fill what is missing on
both sides, so completion by the true plane is the best result that it can reach. A third sample of the whole object in
place of the points gives the error that is due to sampling alone. The objects are generated, in random poses; the paper
has a figure with other objects and no numbers.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree
from tqdm import tqdm

import symjax
from experiments.baselines.registry import ENTRIES
from experiments.comparison.attempt import attempt
from experiments.data import GENERATED
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from symjax import datasets
from symjax.datasets.sample import Sample
from symjax.geometry.plane import Plane

NOT_COMPLETED, TRUE_PLANE, RESAMPLED = "not completed", "the true plane", "resampled"
"""References for the methods."""

UP = np.array([0.0, 0.0, 1.0])
"""Upward direction of generated objects in their own frames."""

PANEL = (1500, 750)
"""Width and height of an object in the figure, in pixels."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        kinds: kinds of object with a single mirror plane, separated by commas.
        seeds: objects of each kind.
        num_points: points of a whole object.
        missing: share of the points that is removed as one part.
        methods: names of the methods, separated by commas.
        drawn: largest number of objects in the figure, the first of each kind.
    """

    kinds: str = "quadruped,human,chair,aeroplane,teapot,head,car,bird"
    seeds: int = 5
    num_points: int = 5000
    missing: float = 0.28
    methods: str = "robust,sym-hks,3dsymm"
    drawn: int = 4


SIZES = {"full": Config(), "small": Config(kinds="quadruped,human,chair,aeroplane", seeds=1)}


class Part(NamedTuple):
    """An object with a missing part, and two other samples of it that share no points with it or each other.

    Attributes:
        whole: sample of the whole object, twice as dense, in the same pose.
        kept: remaining points.
        removed: removed points.
        resampled: another sample of the whole object, with as many points as `kept` and `removed` together.
    """

    whole: Sample
    kept: Float[np.ndarray, "k 3"]
    removed: Float[np.ndarray, "r 3"]
    resampled: Float[np.ndarray, "n 3"]

    @property
    def plane(self) -> Plane:
        """The true plane."""
        return Plane(self.whole.normals[0], np.asarray(self.whole.offsets[0]))


def part(config: Config, kind: str, seed: int, *, posed: bool) -> Part:
    """Generates an object and removes a part, which is the same in the object's own frame and in a random pose."""
    rng = np.random.default_rng([seed, *kind.encode()])
    whole = datasets.generate(kind, num_points=4 * config.num_points, rng=rng)
    if posed:
        # the unit of length is then the diagonal of the object in its own frame
        whole = datasets.pose(whole, np.random.default_rng([seed, 1]), scale=1 / whole.diagonal)
    order = np.random.default_rng([seed, 2]).permutation(len(whole.points))
    points, resampled, reference = np.split(whole.points[order], [config.num_points, 2 * config.num_points])
    kept, rows = datasets.remove_part(points, config.missing, np.random.default_rng([seed, 3]))
    return Part(whole._replace(points=reference), kept, np.delete(points, rows, axis=0), resampled)


def run(config: Config) -> list[Row]:
    """Returns one row per object and way of completing it."""
    methods = split_names(config.methods, ENTRIES)
    objects = [(kind, seed) for kind in split_names(config.kinds, datasets.KINDS) for seed in range(config.seeds)]
    return [
        {"kind": kind, "seed": seed} | row
        for kind, seed in tqdm(objects, disable=None)
        for row in _completed(part(config, kind, seed, posed=True), methods)
    ]


def _completed(cut: Part, methods: list[str]) -> Iterator[Row]:
    nothing = np.empty((0, 3))
    unchanged = _errors(cut, cut.kept, nothing)
    yield {"completed by": NOT_COMPLETED, "angle": "", **unchanged}
    for method in methods:
        detection = attempt(ENTRIES[method], cut.kept).detection
        errors = {"angle": 90.0, **unchanged} if detection is None else _mirrored(cut, detection.plane)
        yield {"completed by": ENTRIES[method].title, **errors}
    yield {"completed by": TRUE_PLANE, **_mirrored(cut, cut.plane)}
    yield {"completed by": RESAMPLED, "angle": "", **_errors(cut, nothing, cut.resampled)}


def _mirrored(cut: Part, plane: Plane) -> Row:
    return {"angle": float(plane.angle(cut.plane)), **_errors(cut, cut.kept, np.asarray(plane.reflect(cut.kept)))}


def _errors(cut: Part, kept: Float[np.ndarray, "k 3"], added: Float[np.ndarray, "a 3"]) -> Row:
    """Distances from the removed points to the completed cloud, and from the added points to the whole object."""
    gap = cKDTree(np.concatenate([kept, added])).query(cut.removed)[0]
    off = cKDTree(cut.whole.points).query(added)[0]
    return {
        "gap, mean": float(gap.mean()),
        "gap, 95 %": float(np.quantile(gap, 0.95)),
        "added, 95 %": float(np.quantile(off, 0.95)) if len(added) else "",
    }


def summary(rows: list[Row]) -> list[Row]:
    """Returns one line per way of completing, for all objects and for each kind: means and the worst gap."""
    lines = []
    for kind, rows_of_kind in ({"all": rows} | grouped(rows, "kind")).items():
        for way, group in grouped(rows_of_kind, "completed by").items():
            line: Row = {"objects": kind, "number": len(group), "completed by": way}
            for name in ("gap, mean", "gap, 95 %", "added, 95 %"):
                values = [row[name] for row in group if row[name] != ""]
                line[name] = float(np.mean(values)) if values else ""
            line["gap, 95 %, worst"] = max(row["gap, 95 %"] for row in group)
            angles = [row["angle"] for row in group if row["angle"] != ""]
            line["median deg"] = float(np.median(angles)) if angles else ""
            lines.append(line | {"data": "generated", "paper": "figure only, other objects"})
    return lines


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws some objects upright: points, plane and pairs, and beside them the completion by the default method."""
    from PIL import Image

    from symjax.viz import png

    kinds = split_names(config.kinds, datasets.KINDS)[: config.drawn]
    page = Image.new("RGB", (PANEL[0], PANEL[1] * len(kinds)))
    for line, kind in enumerate(kinds):
        detection = symjax.detect(part(config, kind, 0, posed=False).kept, rng=0)
        page.paste(png.draw(detection, size=PANEL, up=UP), (0, line * PANEL[1]))
    page.save(path)
    page.save(path.with_suffix(".pdf"), resolution=200)


STUDY = Study("completion", __doc__, SIZES, run, summary, draw=draw, data=GENERATED, paper="its figure of completion")
