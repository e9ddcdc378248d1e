"""Objects with a part removed, completed by the detected plane (the paper's figure of completion), and how well.

A completed cloud is the points and their mirror images, P ∪ Q (Sec. 5.6). The gap is the distance from the removed
points to it, in diagonals; what is added is measured against another sample of the whole object too, as a wrong plane
adds points where there is no object. Mirroring cannot fill what was removed on both sides: the true plane is the best
that it can do, and a third sample of the whole object, in place of the points, the best that can be seen. Generated
objects, in random poses; the paper has a figure of other objects and no number.
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

OPEN, TRUE, ANEW = "not completed", "the true plane", "sampled anew"
"""What the methods are compared with."""

UP = np.array([0.0, 0.0, 1.0])
"""Of generated objects, in their own frames."""

PANEL = (1500, 750)
"""Pixels of an object in the figure."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        kinds: kinds of object, of a single plane, separated by commas.
        seeds: objects of each kind.
        num_points: points of a whole object.
        missing: share of them that is removed as one part.
        methods: which methods, separated by commas.
        drawn: most objects in the figure, the first of each kind.
    """

    kinds: str = "quadruped,human,chair,aeroplane,teapot,head,car,bird"
    seeds: int = 5
    num_points: int = 5000
    missing: float = 0.28
    methods: str = "robust,sym-hks,3dsymm"
    drawn: int = 4


SIZES = {"full": Config(), "small": Config(kinds="quadruped,human,chair,aeroplane", seeds=1)}


class Part(NamedTuple):
    """An object of which a part is missing.

    Attributes:
        whole: a sample of the whole object, twice as dense, in its pose.
        kept: points that are left.
        removed: points that are not.
        anew: as many points of the whole object again; no two of the samples have a point in common.
    """

    whole: Sample
    kept: Float[np.ndarray, "k 3"]
    removed: Float[np.ndarray, "r 3"]
    anew: Float[np.ndarray, "n 3"]

    @property
    def plane(self) -> Plane:
        """The right plane."""
        return Plane(self.whole.normals[0], np.asarray(self.whole.offsets[0]))


def part(config: Config, kind: str, seed: int, *, posed: bool) -> Part:
    """An object and what is removed of it: the same part in its own frame and in a random pose."""
    rng = np.random.default_rng([seed, *kind.encode()])
    whole = datasets.generate(kind, num_points=4 * config.num_points, rng=rng)
    if posed:
        # distances are then in diagonals of the object in its own frame
        whole = datasets.pose(whole, np.random.default_rng([seed, 1]), scale=1 / whole.diagonal)
    order = np.random.default_rng([seed, 2]).permutation(len(whole.points))
    given, anew, reference = np.split(whole.points[order], [config.num_points, 2 * config.num_points])
    kept, rows = datasets.remove_part(given, config.missing, np.random.default_rng([seed, 3]))
    return Part(whole._replace(points=reference), kept, np.delete(given, rows, axis=0), anew)


def run(config: Config) -> list[Row]:
    """One row an object and way of completing it."""
    methods = split_names(config.methods, ENTRIES)
    objects = [(kind, seed) for kind in split_names(config.kinds, datasets.KINDS) for seed in range(config.seeds)]
    return [
        {"kind": kind, "seed": seed} | row
        for kind, seed in tqdm(objects, disable=None)
        for row in _completed(part(config, kind, seed, posed=True), methods)
    ]


def _completed(cut: Part, methods: list[str]) -> Iterator[Row]:
    nothing = np.empty((0, 3))
    yield {"completed by": OPEN, "angle": "", **_errors(cut, cut.kept, nothing)}
    for method in methods:
        found = attempt(ENTRIES[method], cut.kept).detection
        ended = {"angle": 90.0, **_errors(cut, cut.kept, nothing)} if found is None else _mirrored(cut, found.plane)
        yield {"completed by": ENTRIES[method].title, **ended}
    yield {"completed by": TRUE, **_mirrored(cut, cut.plane)}
    yield {"completed by": ANEW, "angle": "", **_errors(cut, nothing, cut.anew)}


def _mirrored(cut: Part, plane: Plane) -> Row:
    return {"angle": float(plane.angle(cut.plane)), **_errors(cut, cut.kept, np.asarray(plane.reflect(cut.kept)))}


def _errors(cut: Part, kept: Float[np.ndarray, "k 3"], added: Float[np.ndarray, "a 3"]) -> Row:
    """Distances from the removed points to the completed cloud, and from the added points to the whole object."""
    gap = cKDTree(np.concatenate([kept, added])).query(cut.removed)[0]
    beside = cKDTree(cut.whole.points).query(added)[0]
    return {
        "gap, mean": float(gap.mean()),
        "gap, 95 %": float(np.quantile(gap, 0.95)),
        "added, 95 %": float(np.quantile(beside, 0.95)) if len(added) else "",
    }


def summary(rows: list[Row]) -> list[Row]:
    """A line a way of completing, over all objects and for each kind: means over the objects, and the worst of them."""
    lines = []
    for kind, of_kind in ({"all": rows} | grouped(rows, "kind")).items():
        for way, group in grouped(of_kind, "completed by").items():
            line: Row = {"objects": kind, "number": len(group), "completed by": way}
            for name in ("gap, mean", "gap, 95 %", "added, 95 %"):
                values = [row[name] for row in group if row[name] != ""]
                line[name] = float(np.mean(values)) if values else ""
            line["gap, 95 %, worst"] = max(row["gap, 95 %"] for row in group)
            angles = [row["angle"] for row in group if row["angle"] != ""]
            line["median deg"] = float(np.median(angles)) if angles else ""
            lines.append(line | {"data": "generated", "paper": "a figure of others"})
    return lines


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Some objects, upright: the points, plane and pairs, and beside them the completed object, by the default."""
    from PIL import Image

    from symjax.viz import png

    kinds = split_names(config.kinds, datasets.KINDS)[: config.drawn]
    page = Image.new("RGB", (PANEL[0], PANEL[1] * len(kinds)))
    for line, kind in enumerate(kinds):
        found = symjax.detect(part(config, kind, 0, posed=False).kept, rng=0)
        page.paste(png.draw(found, size=PANEL, up=UP), (0, line * PANEL[1]))
    page.save(path)
    page.save(path.with_suffix(".pdf"), resolution=200)


STUDY = Study("completion", __doc__, SIZES, run, summary, draw=draw, data=GENERATED, paper="its figure of completion")
