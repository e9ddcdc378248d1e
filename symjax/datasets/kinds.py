"""The kinds of generated objects, and the function that samples them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from symjax.datasets.sample import Sample, Symmetry
from symjax.datasets.solids import animals, asymmetric, furniture, household, people, regular, vehicles
from symjax.datasets.solids.solid import Solid
from symjax.datasets.solids.surface import sample_surface
from symjax.geometry.checks import choice, whole
from symjax.geometry.seeds import Seed, seeded

Build = Callable[[np.random.Generator], Solid]


class Kind(NamedTuple):
    """A family of random solids that all have the same type of symmetry.

    Attributes:
        symmetry: type of the symmetry. "single" means exactly one mirror plane; "multiple", a finite number of them;
            "continuous", every plane through an axis; "none", no mirror plane.
        build: function that makes a random solid of this kind from a generator.

    Example:
        >>> import symjax
        >>> kind = symjax.datasets.KINDS["drum"]
        >>> kind.symmetry, kind.description
        ('continuous', 'Cylinder: an axis and a plane across it.')
    """

    symmetry: Symmetry
    build: Build

    @property
    def description(self) -> str:
        """One line that describes the kind."""
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
"""All kinds, by name."""


def build(kind: str, rng: Seed = 0) -> Solid:
    """Builds the solid whose surface `generate` samples for the same seed.

    Args:
        kind: a key of `KINDS`.
        rng: seed or generator of the solid's proportions.

    Returns:
        The solid, in its own frame.

    Raises:
        InvalidArgumentError: if the kind is unknown, or `rng` is not a valid seed.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> solid = symjax.datasets.build("ball")
        >>> solid.field(np.zeros((3, 1))) < 0  # the origin is inside the ball
        array([ True])
    """
    choice("kind", kind, KINDS)
    return KINDS[kind].build(seeded(rng).generator)


def generate(kind: str, *, num_points: int = 5000, rng: Seed = 0) -> Sample:
    """Generates a random object of a kind and samples its surface.

    The object is in its own frame: its mirror plane, if it has exactly one, is x = 0; z points up; its size is about 1.
    The points are independent and uniform by area on the outer surface. The sample therefore does not contain
    the mirror images of its points. The planes are exact.

    Args:
        kind: a key of `KINDS`.
        num_points: number of points.
        rng: seed or generator of the object's proportions and of the points.

    Returns:
        The points, and the mirror planes of the object.

    Raises:
        InvalidArgumentError: if the kind is unknown, `num_points` is not a whole number, at least 1, or `rng` is not a
            valid seed.

    Example:
        >>> import symjax
        >>> sample = symjax.datasets.generate("cube", num_points=500)
        >>> sample.points.shape, len(sample.planes)
        ((500, 3), 9)
    """
    num_points = whole("num_points", num_points, 1)
    generator = seeded(rng).generator
    solid = build(kind, generator)
    points = sample_surface(solid.field, num_points, generator)
    return Sample(points, solid.normals, solid.offsets, solid.axis, kind, KINDS[kind].symmetry)
