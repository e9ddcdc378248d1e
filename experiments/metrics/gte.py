"""Ground-truth error (GTE) of PRS-Net (Gao et al., TVCG 2020): distance of planes as 4-vectors.

(a − a′)² + (b − b′)² + (c − c′)² + (d − d′)² for ax + by + cz + d = 0 with unit normals, the sign of the answer
being that which makes it less. The formula is from memory. Papers say both "euclidean" and print numbers that only
fit the square, so both are given.
"""

from typing import NamedTuple

from experiments.metrics.prediction import Prediction
from experiments.metrics.ranking import plane_distance
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane


class GroundTruthError(NamedTuple):
    """Distance of an answer from the nearest truth.

    Attributes:
        squared: the sum of squares, which the published tables hold.
        plain: its square root.
    """

    squared: float
    plain: float


def gte(prediction: Prediction) -> GroundTruthError:
    """GTE of the best answer of a case: the least over its truths.

    That the best answer alone is scored is our choice: which planes the published means run over is not known.

    Args:
        prediction: at least one answer and one truth.

    Raises:
        InvalidArgumentError: no answer, or no truth.
    """
    if not len(prediction.ranking.offsets) or not prediction.case.planes:
        raise InvalidArgumentError(f"GTE of {prediction.case.name!r}: an answer and a truth are needed")
    answers, truths = map(prediction.to_diagonals.plane, (prediction.answers, prediction.truths))
    plain = float(plane_distance(truths, Plane(answers.normal[0], answers.offset[0])).min())
    return GroundTruthError(plain**2, plain)
