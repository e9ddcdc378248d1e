"""Precision, recall and F of the ICCV 2017 challenge (Funk et al. 2017), and the paper's version of them.

A predicted plane matches a true one if the angle between their normals is below t_a (0 to 45°) and the distance between
the centres of their rectangles is below t_d (0 to 2 s, where s is the shortest side of the two rectangles). Counts are
pooled over the data set. Each predicted plane, best first, takes the free true plane of smallest angle among those that
it matches; this matching rule is quoted from memory.

The paper puts every centre at the mean of the cloud, so that every t_d is satisfied, and scores one predicted plane
against one true plane per shape. Precision, recall and F are then the same number, the share of planes within t_a, and
their curve is the diagonal. The paper does not state t_a and t_d of its F-measures.
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
"""Largest t_a of the sweep, in degrees."""

LARGEST_DISTANCE = 2.0
"""Largest t_d of the sweep, in multiples of s."""


class Compared(NamedTuple):
    """Rectangles of the predicted planes of one shape, best first, and of its true planes."""

    answers: Patches
    truths: Patches


def compared(prediction: Prediction, truths: Patches | None = None) -> Compared:
    """Computes the rectangles of a case, which bound its whole cloud.

    Args:
        prediction: the case and its predicted planes.
        truths: published rectangles of the true planes; by default they bound the cloud too.
    """
    points = prediction.case.points
    return Compared(bounding(prediction.answers, points), truths or bounding(prediction.truths, points))


def as_in_the_paper(prediction: Prediction) -> Compared:
    """Pairs the best predicted plane with the true plane nearest to it, both centred at the mean of the cloud."""
    answers, truths = compared(prediction)
    best = slice(0, 1)
    if len(answers.sides) and len(truths.sides):
        nearest = int(np.argmin(deviation_angle(truths.normals, answers.normals[0])))
        truths = Patches(*(column[nearest : nearest + 1] for column in truths))
    centre = prediction.case.points.mean(axis=0)
    one_each = (Patches(*(column[best] for column in patches)) for patches in (answers, truths))
    return Compared(*(patches._replace(centres=np.tile(centre, (len(patches.sides), 1))) for patches in one_each))


def tally(shapes: Sequence[Compared], angle: float, distance: float) -> Tally:
    """Pools the counts of all shapes at one pair of thresholds.

    Args:
        shapes: rectangles of all shapes.
        angle: t_a in degrees.
        distance: t_d in multiples of s.
    """
    return pooled(_tally(shape, angle, distance) for shape in shapes)


def curve(shapes: Sequence[Compared], steps: int = 45) -> list[Tally]:
    """Pools the counts as both thresholds rise together from 0 to their largest: the curve of precision and recall."""
    return [tally(shapes, LARGEST_ANGLE * part, LARGEST_DISTANCE * part) for part in np.linspace(0, 1, steps + 1)]


def _tally(shape: Compared, angle: float, distance: float) -> Tally:
    answers, truths = shape
    degrees = np.asarray(deviation_angle(answers.normals[:, None], truths.normals[None]))
    apart = np.linalg.norm(answers.centres[:, None] - truths.centres[None], axis=2)
    near = (degrees < angle) & (apart < distance * np.minimum(answers.sides[:, None], truths.sides[None]))
    matched = matching.by_rank(np.where(near, degrees, np.inf)) >= 0
    return Tally(int(matched.sum()), len(answers.sides), len(truths.sides))
