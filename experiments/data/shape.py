"""An object of a benchmark in its own frame, which samples clouds of itself in random poses."""

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
    """A surface and its true mirror planes.

    Attributes:
        name: name within the benchmark.
        group: the benchmark, and the part of it.
        surface: a mesh; without triangles if the benchmark publishes a cloud.
        planes: true planes; empty if the benchmark publishes none for the object.
        diagonal: diagonal of the bounding box in the object's own frame; a pose does not change it.
        axis: point on and direction of an axis of revolution; every plane through it is a true plane as well.
        corners: three corners of the rectangle of every plane, if the benchmark publishes rectangles.
    """

    name: str
    group: str
    surface: mesh.Mesh
    planes: tuple[Plane, ...]
    diagonal: float
    axis: Axis | None = None
    corners: Float[np.ndarray, "k 3 3"] | None = None

    def posed(self, seed: int) -> "Shape":
        """Returns the shape in a random pose: turned, perhaps reflected, and shifted. The seed determines the pose."""
        by_count: tuple[Symmetry, ...] = ("none", "single", "multiple")
        symmetry: Symmetry = "continuous" if self.axis else by_count[min(len(self.planes), 2)]
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
        """Samples a mesh uniformly by area, or draws at most `num_points` points of a cloud without replacement."""
        if len(self.surface.triangles):
            return mesh.sample(self.surface, num_points, rng)
        return self.surface.vertices[rng.permutation(len(self.surface.vertices))[:num_points]]

    def case(self, num_points: int, seed: int) -> Case:
        """Samples a cloud on the shape in the pose `posed(seed)`."""
        posed = self.posed(seed)
        points = posed.points(num_points, np.random.default_rng([seed, 1, *self.name.encode()]))
        return Case(self.name, self.group, points, posed.planes, self.diagonal, seed, posed.axis)


def read_shape(path: Path, name: str, group: str, planes: Iterable[Plane] = (), axis: Axis | None = None) -> Shape:
    """Reads the surface of a shape from a mesh or a cloud in any format that symjax reads.

    Args:
        path: file of the surface.
        name: name of the object within the benchmark.
        group: the benchmark, and the part of it.
        planes: true planes in the frame of the file, with unit normals.
        axis: point on and direction of an axis of revolution, if there is one.

    Raises:
        FileFormatError: if the file is damaged or not of the format that its extension names.
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
    """Returns the plane through a point; the normal need not be of unit length."""
    unit = normal / np.linalg.norm(normal)
    return Plane(unit, np.asarray(unit @ point))
