"""A cloud with its known planes, and its random pose."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.solid import Axis
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity

Symmetry = Literal["single", "multiple", "continuous", "none"]


class Sample(NamedTuple):
    """Points of an object and its mirror planes `normals[i] . x = offsets[i]`, in the units of the points.

    With an `axis` (point, direction) every plane through it is a mirror as well, and not among those listed.
    """

    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "p 3"]
    offsets: Float[np.ndarray, " p"]
    axis: Axis | None
    kind: str
    symmetry: Symmetry

    @property
    def planes(self) -> tuple[tuple[Float[np.ndarray, " 3"], float], ...]:
        """The planes as pairs (normal, offset)."""
        return tuple((n, float(d)) for n, d in zip(self.normals, self.offsets, strict=True))

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the axis-aligned bounding box; it changes with the pose."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))


def pose(
    sample: Sample,
    rng: int | np.random.Generator = 0,
    *,
    scale: float = 1.0,
    shift: float = 1.0,
    reflect: bool | None = None,
) -> Sample:
    """The sample turned at random, perhaps reflected, scaled and shifted, its planes and axis with it.

    Corruptions come after this: a box of outliers along the object's own axes would be symmetric itself.

    Args:
        sample: A cloud and its planes.
        rng: Seed or generator.
        scale: Factor on all lengths.
        shift: Standard deviation of each coordinate of the shift, in diagonals of the sample.
        reflect: Whether the pose reverses handedness; None tosses a coin.

    Raises:
        InvalidArgumentError: The scale is not positive and finite.
    """
    if not 0 < scale < np.inf:
        raise InvalidArgumentError(f"scale must be positive and finite, got {scale}")
    rng = np.random.default_rng(rng)
    turn = random_orthogonal(rng, reflect=reflect)
    move = rng.normal(size=3) * shift * sample.diagonal * scale
    posed = Similarity(scale, turn, move)
    points = np.asarray(posed.points(sample.points))
    normals, offsets = map(np.asarray, posed.plane(Plane(sample.normals, sample.offsets)))
    axis = None if sample.axis is None else posed.axis(sample.axis)
    return sample._replace(points=points, normals=normals, offsets=offsets, axis=axis)


def random_orthogonal(rng: np.random.Generator, *, reflect: bool | None = None) -> Float[np.ndarray, "3 3"]:
    """Orthogonal matrix of the Haar measure (Mezzadri 2007: QR of a normal matrix with R's signs undone)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    if reflect is not None and (np.linalg.det(q) < 0) != reflect:
        q = -q
    return q
