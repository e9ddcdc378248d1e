"""An object of a benchmark in its own frame, and the posed cases that are made of it."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data.cases import Case
from symjax import datasets
from symjax.datasets.sample import Symmetry
from symjax.errors import FileFormatError
from symjax.geometry.plane import Plane
from symjax.io import mesh
from symjax.io.points import MESHES, read_points
from symjax.method.result import Axis


class Shape(NamedTuple):
    """A surface and the planes that are right for it.

    Attributes:
        name: within its benchmark.
        group: the benchmark, and which part of it.
        surface: a mesh; a cloud has no triangles.
        planes: none where the benchmark publishes none for it.
        diagonal: of the bounding box in the shape's own frame; it stays when the shape is posed.
        axis: point and direction; every plane through it is right as well.
        corners: three of the rectangle of every plane, where the benchmark publishes them.
    """

    name: str
    group: str
    surface: mesh.Mesh
    planes: tuple[Plane, ...]
    diagonal: float
    axis: Axis | None = None
    corners: Float[np.ndarray, "k 3 3"] | None = None

    def posed(self, seed: int) -> "Shape":
        """In the random pose of a seed: turned, perhaps reflected, and shifted, mesh, planes and corners alike."""
        by_number: tuple[Symmetry, ...] = ("none", "single", "multiple")
        symmetry: Symmetry = "continuous" if self.axis else by_number[min(len(self.planes), 2)]
        normals = np.array([plane.normal for plane in self.planes]).reshape(-1, 3)
        offsets = np.array([float(plane.offset) for plane in self.planes])
        count = len(self.surface.vertices)
        corners = np.empty((0, 3)) if self.corners is None else self.corners.reshape(-1, 3)
        points = np.concatenate([self.surface.vertices, corners])
        whole = datasets.Sample(points, normals, offsets, self.axis, self.name, symmetry)
        moved = datasets.pose(whole, np.random.default_rng([seed, *self.name.encode()]))
        planes = tuple(Plane(n, np.asarray(w)) for n, w in zip(moved.normals, moved.offsets, strict=True))
        return self._replace(
            surface=self.surface._replace(vertices=moved.points[:count]),
            planes=planes,
            axis=moved.axis,
            corners=None if self.corners is None else moved.points[count:].reshape(-1, 3, 3),
        )

    def points(self, num_points: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
        """Points uniform by area on a mesh; of a cloud at most so many of its own."""
        if len(self.surface.triangles):
            return mesh.sample(self.surface, num_points, rng)
        return self.surface.vertices[rng.permutation(len(self.surface.vertices))[:num_points]]

    def case(self, num_points: int, seed: int) -> Case:
        """A cloud of the shape as `posed(seed)` has it."""
        posed = self.posed(seed)
        points = posed.points(num_points, np.random.default_rng([seed, 1, *self.name.encode()]))
        return Case(self.name, self.group, points, posed.planes, self.diagonal, seed, posed.axis)


def read_shape(path: Path, name: str, group: str, planes: Iterable[Plane] = (), axis: Axis | None = None) -> Shape:
    """A shape whose surface is in a file.

    Raises:
        FileFormatError: the file is not what its extension says, or damaged.
    """
    surface = _read_surface(path)
    used = surface.vertices[surface.triangles.ravel()] if len(surface.triangles) else surface.vertices
    return Shape(name, group, surface, tuple(planes), float(np.linalg.norm(np.ptp(used, axis=0))), axis)


def _read_surface(path: Path) -> mesh.Mesh:
    if path.suffix.lower() not in MESHES:
        return mesh.Mesh(read_points(path).points, np.empty((0, 3), np.int64), 0)
    try:
        return MESHES[path.suffix.lower()](path.read_bytes())
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from error


def through(normal: Float[np.ndarray, " 3"], point: Float[np.ndarray, " 3"]) -> Plane:
    """The plane through a point; the normal need not be of unit length."""
    unit = normal / np.linalg.norm(normal)
    return Plane(unit, np.asarray(unit @ point))
