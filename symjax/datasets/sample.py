"""Generated clouds with known mirror planes, and their random poses."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.solids.solid import Axis
from symjax.geometry.checks import flag, number
from symjax.geometry.plane import Plane
from symjax.geometry.seeds import Seed, seeded
from symjax.geometry.similarity import Similarity

Symmetry = Literal["single", "multiple", "continuous", "none"]


class Sample(NamedTuple):
    """Points on the surface of a generated object, and the object's mirror planes.

    Attributes:
        points: the points.
        normals: unit normals of the mirror planes `normals[i] · x = offsets[i]`.
        offsets: offsets of the mirror planes, in the units of the points.
        axis: a point on the axis of a continuous symmetry and the axis's direction, or None. Every plane through the
            axis is a mirror plane; `normals` does not list these planes.
        kind: name of the object's kind, a key of `KINDS`.
        symmetry: type of the symmetry: "single", "multiple", "continuous" or "none" (see `Kind`).

    Example:
        >>> import symjax
        >>> sample = symjax.datasets.generate("mug", num_points=500)
        >>> sample.kind, sample.symmetry, sample.points.shape, sample.normals
        ('mug', 'single', (500, 3), array([[1., 0., 0.]]))
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
        """Length of the diagonal of the axis-aligned bounding box. It depends on the pose."""
        return float(np.linalg.norm(np.ptp(self.points, axis=0)))


def pose(
    sample: Sample,
    rng: Seed = 0,
    *,
    scale: float = 1.0,
    shift: float = 1.0,
    reflect: bool | None = None,
) -> Sample:
    """Rotates, scales and shifts a sample at random, and may reflect it. Its planes and its axis move along.

    Corrupt a sample after this step, not before: a box of outliers along the object's own axes is symmetric itself.

    Args:
        sample: a cloud and its planes.
        rng: seed or generator of the pose.
        scale: factor by which all lengths are multiplied.
        shift: standard deviation of each coordinate of the shift, as a multiple of the sample's diagonal after scaling.
        reflect: whether the pose reverses handedness; None decides at random.

    Returns:
        The posed sample.

    Raises:
        InvalidArgumentError: if an option has a wrong type, the scale is not positive and finite, or `rng` is not a
            valid seed.

    Example:
        >>> import symjax
        >>> sample = symjax.datasets.generate("mug", num_points=500)
        >>> posed = symjax.datasets.pose(sample, rng=1, scale=2.0)
        >>> before = sample.points @ sample.normals[0] - sample.offsets[0]
        >>> after = posed.points @ posed.normals[0] - posed.offsets[0]
        >>> print(f"{max(abs(after - 2 * before)):.6f}")
        0.000000
    """
    scale, shift = number("scale", scale, above=0), number("shift", shift)
    if reflect is not None:
        flag("reflect", reflect)
    generator = seeded(rng).generator
    turn = random_orthogonal(generator, reflect=reflect)
    move = generator.normal(size=3) * shift * sample.diagonal * scale
    posed = Similarity(scale, turn, move)
    points = np.asarray(posed.points(sample.points))
    normals, offsets = map(np.asarray, posed.plane(Plane(sample.normals, sample.offsets)))
    axis = None if sample.axis is None else posed.axis(sample.axis)
    return sample._replace(points=points, normals=normals, offsets=offsets, axis=axis)


def random_orthogonal(rng: np.random.Generator, *, reflect: bool | None = None) -> Float[np.ndarray, "3 3"]:
    """Draws a Haar-distributed orthogonal matrix: QR of a Gaussian matrix, with R's signs undone (Mezzadri 2007)."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    if reflect is not None and (np.linalg.det(q) < 0) != reflect:
        q = -q
    return q
