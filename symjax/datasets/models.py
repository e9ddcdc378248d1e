"""Real models, as published: a surface or a scan, points on it, and the mirror plane where one is known."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.download import fetch
from symjax.datasets.registry import MODELS
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.io import mesh
from symjax.io.points import MESHES, NUM_SAMPLES, read_points


class Model(NamedTuple):
    """A real model in its own frame and units.

    Attributes:
        points: uniform by area on a mesh; a scan's own.
        surface: vertices and triangles; a scan has no triangles.
        plane: the mirror plane; None if no one plane is known.
        symmetry: how exact the plane is, or why none is given: "exact", "approximate", "no symmetry", ...
        licence: of the model; it may ask that the attribution be given.
        attribution: whom to name.
        path: the file as it was published.
    """

    points: Float[np.ndarray, "n 3"]
    surface: mesh.Mesh
    plane: Plane | None
    symmetry: str
    licence: str
    attribution: str
    path: Path


def load(name: str, *, num_samples: int = NUM_SAMPLES, rng: int | np.random.Generator = 0) -> Model:
    """A real model; its original is downloaded on first use and kept in the user's cache folder.

    Needs pooch (the extra `datasets`), and the internet the first time. The file is the one whose plane is known:
    another sha256 is refused.

    Args:
        name: a key of `MODELS`.
        num_samples: points to sample from a mesh; a scan is taken as it is.
        rng: seed or generator of the sampling.

    Raises:
        InvalidArgumentError: there is no such model, `num_samples` is not positive, or pooch is not installed.
        FileFormatError: the original cannot be downloaded or stored, or is not what was published.
    """
    if name not in MODELS:
        raise InvalidArgumentError(f"no model {name!r}: choose one of {', '.join(MODELS)}")
    if num_samples < 1:
        raise InvalidArgumentError(f"num_samples must be at least 1, got {num_samples}")
    original = MODELS[name]
    path = fetch(name, original)
    surface = _surface(path)
    is_mesh = len(surface.triangles) > 0
    points = mesh.sample(surface, num_samples, np.random.default_rng(rng)) if is_mesh else surface.vertices.copy()
    return Model(points, surface, original.plane, original.symmetry, original.licence, original.attribution, path)


def _surface(path: Path) -> mesh.Mesh:
    if path.suffix in MESHES:
        return MESHES[path.suffix](path.read_bytes())
    return mesh.Mesh(read_points(path).points, np.empty((0, 3), np.int64), 0)
