"""What can be drawn: a cloud with a plane and pairs, such as the answer of `symjax.detect`."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float

from symjax.geometry.plane import Plane


@runtime_checkable
class DrawablePairs(Protocol):
    """Matched points: both ends, in the units of the cloud, and how well each pair agrees with the plane, 0 to 1."""

    @property
    def x(self) -> Float[np.ndarray, "m 3"]:
        """One end of every pair."""

    @property
    def y(self) -> Float[np.ndarray, "m 3"]:
        """The other end."""

    @property
    def weight(self) -> Float[np.ndarray, " m"]:
        """Agreement of every pair with the plane."""


@runtime_checkable
class DrawableCandidate(Protocol):
    """A plane and its score."""

    @property
    def plane(self) -> Plane:
        """The plane."""

    @property
    def score(self) -> float:
        """How well the cloud agrees with it, on the method's scale."""


@runtime_checkable
class Drawable(Protocol):
    """A cloud, its mirror plane, and how far to trust it; `symjax.Detection` is one."""

    @property
    def points(self) -> Float[np.ndarray, "n 3"] | None:
        """The cloud; None cannot be drawn."""

    @property
    def plane(self) -> Plane:
        """The plane, in the units of the cloud."""

    @property
    def candidates(self) -> Sequence[DrawableCandidate]:
        """Distinct planes, the best first; the first is `plane`."""

    @property
    def pairs(self) -> DrawablePairs:
        """The matched points."""

    @property
    def inlier_weight(self) -> float:
        """Weight from which on a pair agrees with the plane."""

    @property
    def inlier_fraction(self) -> float | None:
        """Share of the pairs that agree with the plane; None without pairs."""

    @property
    def found(self) -> bool:
        """Whether the plane is a mirror plane."""

    @property
    def score(self) -> float:
        """How well the cloud agrees with the plane, on the method's scale."""

    @property
    def threshold(self) -> float | None:
        """What the score of a mirror plane exceeds; None for a method that has no threshold."""

    @property
    def ambiguous(self) -> bool:
        """Whether other planes are as good."""

    @property
    def symmetry(self) -> str:
        """What the mirror planes make up: "one plane", "several planes", "axis", "sphere" or "none"."""

    @property
    def method(self) -> str:
        """Name of the method that found the plane."""

    @property
    def notes(self) -> Sequence[str]:
        """What was done to the points, or found in them, as sentences."""

    def on_surface(self) -> Bool[np.ndarray, " n"]:
        """Which points belong to the object."""
