"""Clouds with known mirror planes: generated objects, and the real models of a folder."""

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
"""Default folder of the real models: it holds a `planes.json` (`experiments.data.listing`) and the files it names."""

DENSE = 20_000
"""Points sampled once on a real model; every case is a random subset of them."""


class Case(NamedTuple):
    """A cloud in a random pose and its true mirror planes.

    Attributes:
        name: name of the model, or kind of the generated object.
        group: "generated" for a generated object with one plane, "generated, SYMMETRY" for any other; the `kind` of the
            listing for a real model ("exact", "near-exact", "approximate", …).
        points: the cloud in its pose.
        planes: true planes in the same pose; empty if the object has none.
        diagonal: diagonal of the object's bounding box before the pose.
        seed: seed of the case; tells cases of the same name apart.
        axis: point on and direction of the axis of a solid of revolution, in the same pose; None for other objects.
    """

    name: str
    group: str
    points: Float[np.ndarray, "n 3"]
    planes: tuple[Plane, ...]
    diagonal: float
    seed: int = 0
    axis: Axis | None = None


def kinds_of(symmetry: Symmetry, most: int) -> list[str]:
    """Returns the first `most` generated kinds with a symmetry."""
    return [kind for kind, about in datasets.KINDS.items() if about.symmetry == symmetry][:most]


def generated_cases(num_points: int, seeds: int, kinds: Iterable[str] = tuple(datasets.KINDS)) -> Iterator[Case]:
    """Generates `seeds` objects of every kind, by default of all kinds."""
    for kind in kinds:
        for seed in range(seeds):
            yield generate_case(kind, num_points, seed)


def generate_case(kind: str, num_points: int, seed: int) -> Case:
    """Generates an object of a kind in a random pose; the seed and the kind determine both."""
    rng = np.random.default_rng([seed, *kind.encode()])
    whole = datasets.generate(kind, num_points=num_points, rng=rng)
    posed = datasets.pose(whole, rng)
    group = "generated" if whole.symmetry == "single" else f"generated, {whole.symmetry}"
    planes = tuple(Plane(n, np.asarray(w)) for n, w in zip(posed.normals, posed.offsets, strict=True))
    return Case(kind, group, posed.points, planes, whole.diagonal, seed, posed.axis)


def real_cases(folder: Path, num_points: int, seeds: int) -> Iterator[Case]:
    """Samples the models of a folder by area, each in `seeds` random poses; warns on stderr if there is no listing."""
    listing = folder / LISTING
    if not listing.is_file():
        print(f"REAL MODELS ARE ABSENT: no {listing}; pass --data FOLDER. They are skipped.", file=sys.stderr)
        return
    for name, entry in read_listing(listing).items():
        # the PCD file is a depth-camera cloud: it has no surface to sample, and no true plane
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
