"""Thresholds: the score that a mirror plane must exceed."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from jaxtyping import Float

from symjax.geometry import checks
from symjax.method.result import Candidate
from symjax.robust.quadrics import Quadrics
from symjax.robust.surface import Surface

BACKGROUND = slice(4, 12)
"""Ranks, counted from 0, of the candidates whose median score is the background: the score that a plane reaches on this
cloud as a mere local optimum. Compact round clouds agree to some extent with any plane through their centre."""


@dataclass(frozen=True, kw_only=True)
class FoundThresholds:
    """The threshold: the score that a mirror plane must exceed.

    The threshold is `base + per_background · background`, but at most `most`. It is `exact` instead for a plane whose
    exactness exceeds `exactness + exactness_per_noise · noise`. The defaults were chosen on generated objects and real
    models: `experiments.run calibration` prints the rates of right and wrong answers for them and for other values.

    Attributes:
        base: threshold without any background.
        per_background: increase of the threshold with the background. Compact round clouds agree to some extent with
            any plane through their centre.
        most: upper limit of the threshold, whatever the background.
        exact: threshold of exact planes. Mirror images that lie as close to the surface as its own points are not due
            to chance.
        exactness: exactness that an exact plane must exceed on a clean surface.
        exactness_per_noise: increase of that exactness with the noise. On a noisy surface chance reaches a higher one.

    Example:
        >>> FoundThresholds().threshold(exactness=0.2, background=0.5, noise=0.0)
        array(0.675)
        >>> FoundThresholds().threshold(exactness=0.9, background=0.5, noise=0.0)
        array(0.4)
    """

    base: float = 0.36
    per_background: float = 0.63
    most: float = 0.8
    exact: float = 0.4
    exactness: float = 0.5
    exactness_per_noise: float = 0.35

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError if a number is negative or not finite."""
        for field in fields(self):
            checks.number(field.name, getattr(self, field.name), least=0)

    def threshold(self, exactness: Any, background: Any, noise: Any) -> Float[np.ndarray, "*n"]:
        """Returns the threshold of a plane, or of an array of planes.

        Args:
            exactness: exactness of the plane; 0 if it is not known.
            background: median score of other candidates, see `background`.
            noise: noise of the surface, see `relative_noise`.
        """
        usual = np.minimum(self.base + self.per_background * np.asarray(background), self.most)
        return np.where(exactness > self.exactness + self.exactness_per_noise * np.asarray(noise), self.exact, usual)


def background(ranked: Sequence[Candidate]) -> float:
    """Returns the median score of the candidates in the ranks BACKGROUND, or 0 if there are too few candidates."""
    return float(np.median([c.score for c in ranked[BACKGROUND]])) if len(ranked) > BACKGROUND.start else 0.0


def relative_noise(surface: Surface, quadrics: Quadrics) -> float:
    """Returns the scatter of a surface about its quadrics, in tolerances of the surface."""
    return quadrics.scatter / surface.tolerance
