"""Ground-truth error (GTE) of PRS-Net (Gao et al., TVCG 2020): distance of planes as 4-vectors.

(a − a′)² + (b − b′)² + (c − c′)² + (d − d′)² for ax + by + cz + d = 0 with unit normals; the sign of the predicted
plane is the one that gives the smaller value. The formula is quoted from memory. Papers call it Euclidean but print
numbers that fit only the squared form, so we compute both.
"""

from typing import NamedTuple

from experiments.metrics.prediction import Prediction
from experiments.metrics.ranking import plane_distance
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane


class GroundTruthError(NamedTuple):
    """Distance of a predicted plane from the nearest true plane.

    Attributes:
        squared: sum of squares, as in the published tables.
        plain: square root of `squared`.
    """

    squared: float
    plain: float


def gte(prediction: Prediction) -> GroundTruthError:
    """Computes the GTE of the best predicted plane of a case: its distance from the nearest true plane.

    We score the best plane alone; the planes over which the published means run are not known.

    Args:
        prediction: a case with at least one true plane, and at least one predicted plane.

    Raises:
        InvalidArgumentError: if there is no predicted or no true plane.
    """
    num_answers, num_truths = len(prediction.ranking.offsets), len(prediction.case.planes)
    if not num_answers or not num_truths:
        raise InvalidArgumentError(
            f"GTE of {prediction.case.name!r} needs at least one predicted and one true plane, "
            f"but there are {num_answers} and {num_truths}"
        )
    answers, truths = map(prediction.to_diagonals.plane, (prediction.answers, prediction.truths))
    plain = float(plane_distance(truths, Plane(answers.normal[0], answers.offset[0])).min())
    return GroundTruthError(plain**2, plain)
