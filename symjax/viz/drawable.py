"""Protocols of the objects that can be drawn: a cloud with its plane and pairs, such as a `symjax.Detection`."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float

from symjax.geometry.plane import Plane


@runtime_checkable
class DrawablePairs(Protocol):
    """Pairs of points, in the units of the cloud."""

    @property
    def x(self) -> Float[np.ndarray, "m 3"]:
        """First point of each pair."""

    @property
    def y(self) -> Float[np.ndarray, "m 3"]:
        """Second point of each pair."""

    @property
    def weight(self) -> Float[np.ndarray, " m"]:
        """How well each pair agrees with the plane, 0 to 1."""


@runtime_checkable
class DrawableCandidate(Protocol):
    """A candidate plane and its score."""

    @property
    def plane(self) -> Plane:
        """The plane."""

    @property
    def score(self) -> float:
        """Score of the plane, on the scale of the method."""


@runtime_checkable
class Drawable(Protocol):
    """A cloud, its mirror plane, and the evidence for the plane. `symjax.Detection` implements this protocol."""

    @property
    def points(self) -> Float[np.ndarray, "n 3"] | None:
        """The cloud. Drawing raises TooFewPointsError if it is None."""

    @property
    def plane(self) -> Plane:
        """The plane, in the units of the cloud."""

    @property
    def candidates(self) -> Sequence[DrawableCandidate]:
        """Distinct candidate planes, best first. The first is `plane`."""

    @property
    def pairs(self) -> DrawablePairs:
        """The pairs that the plane was fitted to."""

    @property
    def inlier_weight(self) -> float:
        """Smallest weight of a pair that counts as an inlier."""

    @property
    def inlier_fraction(self) -> float | None:
        """Fraction of the pairs that are inliers; None if there are no pairs."""

    @property
    def found(self) -> bool:
        """Whether the method accepts the plane as a mirror plane."""

    @property
    def score(self) -> float:
        """Score of the plane, on the scale of the method."""

    @property
    def threshold(self) -> float | None:
        """Value that the score of a mirror plane must exceed; None if the method has no threshold."""

    @property
    def ambiguous(self) -> bool:
        """Whether other planes are as good as this one."""

    @property
    def symmetry(self) -> str:
        """Type of the symmetry: "one plane", "several planes", "axis", "sphere" or "none"."""

    @property
    def method(self) -> str:
        """Name of the method that found the plane."""

    @property
    def notes(self) -> Sequence[str]:
        """Remarks about the cloud and its preprocessing, as sentences."""

    def on_surface(self) -> Bool[np.ndarray, " n"]:
        """Returns a mask of the points that lie on the object."""
