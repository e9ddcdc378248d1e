"""Real models: a published mesh or scan, points on its surface, and its mirror plane if that is known."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.download import fetch
from symjax.datasets.registry import MODELS
from symjax.geometry.checks import choice, whole
from symjax.geometry.plane import Plane
from symjax.geometry.seeds import Seed, seeded
from symjax.io import mesh
from symjax.io.points import MESHES, NUM_SAMPLES, read_points


class Model(NamedTuple):
    """A real model in its own frame and units.

    Attributes:
        points: points uniform by area on the mesh, or the points of the scan.
        surface: vertices and triangles of the mesh; a scan has no triangles.
        plane: the mirror plane; None if no single plane is known.
        symmetry: how exact the plane is ("exact", "approximate", …), or why no plane is given ("no symmetry", …).
        licence: licence of the model; it may require the attribution.
        attribution: names of the authors.
        path: the published file, in the cache folder.

    Example:
        `load` returns a model. What is known about it can be read before the download:

        >>> import symjax
        >>> spot = symjax.datasets.MODELS["spot"]
        >>> spot.symmetry, spot.licence
        ('exact', 'public domain')
        >>> spot.plane.normal
        array([1., 0., 0.])
    """

    points: Float[np.ndarray, "n 3"]
    surface: mesh.Mesh
    plane: Plane | None
    symmetry: str
    licence: str
    attribution: str
    path: Path


def load(name: str, *, num_samples: int = NUM_SAMPLES, rng: Seed = 0) -> Model:
    """Loads a real model. The first call downloads it; later calls read it from the user's cache folder.

    Needs pooch (the extra `datasets`). The plane is known for one version of each file, so a file with another
    sha256 is refused.

    Args:
        name: a key of `MODELS`.
        num_samples: number of points to sample from a mesh; a scan keeps its own points.
        rng: seed or generator of the sampling.

    Returns:
        The model, with its mirror plane if that is known.

    Raises:
        InvalidArgumentError: if the model is unknown, `num_samples` is not a whole number, at least 1, `rng` is not a
            valid seed, or pooch is not installed.
        FileFormatError: if the file cannot be downloaded or stored, or differs from the published one.

    Example:
        >>> import symjax
        >>> sorted(symjax.datasets.MODELS)[:4]
        ['boat', 'boot', 'car6', 'cat']
        >>> symjax.datasets.load("unicorn")
        Traceback (most recent call last):
        symjax.errors.InvalidArgumentError: model 'unicorn' is unknown: choose one of boat, boot, ...
    """
    choice("model", name, MODELS)
    num_samples = whole("num_samples", num_samples, 1)
    generator = seeded(rng).generator
    original = MODELS[name]
    path = fetch(name, original)
    surface = _surface(path)
    is_mesh = len(surface.triangles) > 0
    points = mesh.sample(surface, num_samples, generator) if is_mesh else surface.vertices.copy()
    return Model(points, surface, original.plane, original.symmetry, original.licence, original.attribution, path)


def _surface(path: Path) -> mesh.Mesh:
    if path.suffix in MESHES:
        return MESHES[path.suffix](path.read_bytes())
    return mesh.Mesh(read_points(path).points, np.empty((0, 3), np.int64), 0)
