"""Clouds with known planes to detect: generated objects, and the real models of a folder."""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data.listing import LISTING, Entry, read_listing
from experiments.framework.project import PROJECT
from symjax import datasets
from symjax.datasets.sample import Symmetry
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity
from symjax.io.points import read_points
from symjax.method.result import Axis

MODELS = PROJECT.parent / "shared" / "data"
"""Where the real models are looked for: a folder with `planes.json` and the files that it names."""

DENSE = 20_000
"""Points on a real model, of which every case draws its own."""


class Case(NamedTuple):
    """A posed cloud and the planes that are right for it; none for an object without.

    Attributes:
        name: model or kind.
        group: "exact", "near-exact", "approximate", "generated" or, where no one plane is right, what it has.
        points: the cloud in a random pose.
        planes: the right planes, in the same pose.
        diagonal: of the object's bounding box before it was turned.
        seed: number of the case among those of its name.
        axis: point and direction, in the same pose, of a generated solid of revolution.
    """

    name: str
    group: str
    points: Float[np.ndarray, "n 3"]
    planes: tuple[Plane, ...]
    diagonal: float
    seed: int = 0
    axis: Axis | None = None


def kinds_of(symmetry: Symmetry, most: int) -> list[str]:
    """The first generated kinds of a symmetry."""
    return [kind for kind, about in datasets.KINDS.items() if about.symmetry == symmetry][:most]


def generated(num_points: int, seeds: int, kinds: Iterable[str] = tuple(datasets.KINDS)) -> Iterator[Case]:
    """Some generated kinds, by default all, `seeds` objects of each."""
    for kind in kinds:
        for seed in range(seeds):
            yield made(kind, num_points, seed)


def made(kind: str, num_points: int, seed: int) -> Case:
    """An object of a kind in a random pose."""
    rng = np.random.default_rng([seed, *kind.encode()])
    whole = datasets.generate(kind, num_points=num_points, rng=rng)
    posed = datasets.pose(whole, rng)
    group = "generated" if whole.symmetry == "single" else f"generated, {whole.symmetry}"
    planes = tuple(Plane(n, np.asarray(w)) for n, w in zip(posed.normals, posed.offsets, strict=True))
    return Case(kind, group, posed.points, planes, whole.diagonal, seed, posed.axis)


def real(folder: Path, num_points: int, seeds: int) -> Iterator[Case]:
    """The models of a folder, sampled by area, in `seeds` random poses each; says so loudly where it is absent."""
    listing = folder / LISTING
    if not listing.is_file():
        print(f"REAL MODELS ARE ABSENT: no {listing}; pass --data FOLDER. Skipped.", file=sys.stderr)
        return
    for name, entry in read_listing(listing).items():
        # a depth-camera cloud has no surface to sample anew and no plane to compare with
        if Path(entry.file).suffix == ".pcd":
            continue
        dense = read_points(folder / entry.file, num_samples=DENSE, rng=7).points
        for seed in range(seeds):
            yield _posed(name, entry, dense, num_points, seed)


def _posed(name: str, entry: Entry, dense: Float[np.ndarray, "n 3"], num_points: int, seed: int) -> Case:
    rng = np.random.default_rng([seed, *name.encode()])
    diagonal = float(np.linalg.norm(np.ptp(dense, axis=0)))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    to_posed = Similarity(1.0, turn, rng.normal(size=3) * diagonal)
    points = np.asarray(to_posed.points(dense[rng.permutation(len(dense))[:num_points]]))
    return Case(name, entry.kind, points, tuple(map(to_posed.plane, entry.planes)), diagonal, seed)
