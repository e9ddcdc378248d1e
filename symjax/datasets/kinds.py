"""The kinds of object, and clouds sampled from them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from symjax.datasets.sample import Sample, Symmetry
from symjax.datasets.solids import animals, asymmetric, furniture, household, people, regular, vehicles
from symjax.datasets.solids.solid import Solid
from symjax.datasets.solids.surface import sample_surface
from symjax.errors import InvalidArgumentError

Build = Callable[[np.random.Generator], Solid]


class Kind(NamedTuple):
    """A family of random solids and the symmetry that all of them share."""

    symmetry: Symmetry
    build: Build

    @property
    def description(self) -> str:
        """What it is, in a line."""
        return (self.build.__doc__ or "").strip()


_FAMILIES: dict[Symmetry, tuple[Build, ...]] = {
    "single": (
        furniture.chair,
        furniture.sofa,
        furniture.desk,
        furniture.lamp,
        furniture.wheelchair,
        vehicles.car,
        vehicles.aeroplane,
        vehicles.boat,
        vehicles.bicycle,
        animals.quadruped,
        animals.fish,
        animals.bird,
        animals.insect,
        people.human,
        people.head,
        people.spectacles,
        household.mug,
        household.teapot,
        household.watering_can,
        household.jug,
        household.hammer,
        household.guitar,
        household.coat_hook,
    ),
    "multiple": (
        regular.block,
        regular.cube,
        regular.three_axis_ellipsoid,
        regular.table,
        regular.wing_nut,
        regular.prism,
        regular.pyramid,
        regular.stool,
    ),
    "continuous": (regular.ball, regular.drum, regular.ring, regular.bowl, regular.vase, regular.goblet),
    "none": (
        asymmetric.blobs,
        asymmetric.scrap,
        asymmetric.left_boot,
        asymmetric.tree,
        asymmetric.turned_animal,
        asymmetric.mountain,
        asymmetric.hand,
        asymmetric.spring,
    ),
}

KINDS: dict[str, Kind] = {
    build.__name__: Kind(symmetry, build) for symmetry, family in _FAMILIES.items() for build in family
}
"""Every kind by name; `KINDS[name].symmetry`, `KINDS[name].description`."""


def build(kind: str, rng: int | np.random.Generator = 0) -> Solid:
    """The solid whose surface `generate` samples when it is given the same seed.

    Raises:
        InvalidArgumentError: There is no such kind.
    """
    if kind not in KINDS:
        raise InvalidArgumentError(f"no kind {kind!r}: choose one of {', '.join(KINDS)}")
    return KINDS[kind].build(np.random.default_rng(rng))


def generate(kind: str, *, num_points: int = 5000, rng: int | np.random.Generator = 0) -> Sample:
    """A random object of a kind, in its own frame (mirror x = 0 where there is one, z up, about unit size).

    The points are independent and uniform by area on the outer surface, so the mirror image of a point is not
    among them; the planes are exact.

    Args:
        kind: A key of `KINDS`.
        num_points: Number of points.
        rng: Seed or generator: of the object's proportions and of the points.

    Raises:
        InvalidArgumentError: There is no such kind, or num_points is below 1.
    """
    if num_points < 1:
        raise InvalidArgumentError(f"num_points must be at least 1, got {num_points}")
    rng = np.random.default_rng(rng)
    solid = build(kind, rng)
    points = sample_surface(solid.field, num_points, rng)
    return Sample(points, solid.normals, solid.offsets, solid.axis, kind, KINDS[kind].symmetry)
