"""Precision, recall and F of the ICCV 2017 challenge (Funk et al. 2017), and as the paper uses them.

An answer is right where its normal is within t_a of the truth's, 0 to 45°, and its centre within t_d, 0 to 2 s, s the
shortest side of the two rectangles. Counts are pooled over the data set. Each answer, best first, takes the free truth
of least angle among those that it agrees with: this rule of matching is from memory.

The paper puts every centre at the mean of the cloud, so that any t_d is kept to, and scores one answer against one
truth a shape: precision, recall and F are then one number, the share of answers within t_a, and their curve is the
diagonal. Which t_a and t_d its F-measures are for is not stated.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from experiments.metrics import matching
from experiments.metrics.matching import Tally, pooled
from experiments.metrics.patch import Patches, bounding
from experiments.metrics.prediction import Prediction
from symjax.geometry.directions import deviation_angle

LARGEST_ANGLE = 45.0
"""Degrees up to which t_a is swept."""

LARGEST_DISTANCE = 2.0
"""Multiple of s up to which t_d is swept."""


class Compared(NamedTuple):
    """The rectangles of the answers of one shape, best first, and those of its truths."""

    answers: Patches
    truths: Patches


def compared(prediction: Prediction, truths: Patches | None = None) -> Compared:
    """Rectangles of a case, bounding its whole cloud.

    Args:
        prediction: the case and its answers.
        truths: rectangles of the truths, from a file; by default they bound the cloud as those of the answers do.
    """
    points = prediction.case.points
    return Compared(bounding(prediction.answers, points), truths or bounding(prediction.truths, points))


def as_in_the_paper(prediction: Prediction) -> Compared:
    """The best answer and the truth nearest to it, both centred at the mean of the cloud."""
    answers, truths = compared(prediction)
    best = slice(0, 1)
    if len(answers.sides) and len(truths.sides):
        nearest = int(np.argmin(deviation_angle(truths.normals, answers.normals[0])))
        truths = Patches(*(column[nearest : nearest + 1] for column in truths))
    centre = prediction.case.points.mean(axis=0)
    one_each = (Patches(*(column[best] for column in patches)) for patches in (answers, truths))
    return Compared(*(patches._replace(centres=np.tile(centre, (len(patches.sides), 1))) for patches in one_each))


def tally(shapes: Sequence[Compared], angle: float, distance: float) -> Tally:
    """Pooled counts at one pair of thresholds.

    Args:
        shapes: all shapes.
        angle: t_a in degrees.
        distance: t_d in multiples of s.
    """
    return pooled(_tally(shape, angle, distance) for shape in shapes)


def curve(shapes: Sequence[Compared], steps: int = 45) -> list[Tally]:
    """Pooled counts as both thresholds rise together from 0 to their largest: the curve of precision and recall."""
    return [tally(shapes, LARGEST_ANGLE * part, LARGEST_DISTANCE * part) for part in np.linspace(0, 1, steps + 1)]


def _tally(shape: Compared, angle: float, distance: float) -> Tally:
    answers, truths = shape
    degrees = np.asarray(deviation_angle(answers.normals[:, None], truths.normals[None]))
    apart = np.linalg.norm(answers.centres[:, None] - truths.centres[None], axis=2)
    right = (degrees < angle) & (apart < distance * np.minimum(answers.sides[:, None], truths.sides[None]))
    matched = matching.by_rank(np.where(right, degrees, np.inf)) >= 0
    return Tally(int(matched.sum()), len(answers.sides), len(truths.sides))
