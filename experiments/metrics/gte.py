"""Ground-truth error (GTE) of PRS-Net (Gao et al., TVCG 2020): distance of planes as 4-vectors.

(a − a′)² + (b − b′)² + (c − c′)² + (d − d′)² for ax + by + cz + d = 0 with unit normals, the sign of the answer
being that which makes it less. The formula is from memory. Papers say both "euclidean" and print numbers that only
fit the square, so both are given.
"""

from typing import NamedTuple

from experiments.baselines.ranking import plane_distance
from experiments.metrics.frame import Frame, frame_of
from experiments.metrics.prediction import Prediction
from symjax.errors import InvalidArgumentError


class GroundTruthError(NamedTuple):
    """Distance of an answer from the nearest truth.

    Attributes:
        squared: the sum of squares, which the published tables hold.
        plain: its square root.
    """

    squared: float
    plain: float


def gte(prediction: Prediction, frame: Frame | None = None) -> GroundTruthError:
    """GTE of the best answer of a case: the least over its truths.

    That the best answer alone is scored is our choice: which planes the published means run over is not known.

    Args:
        prediction: at least one answer and one truth.
        frame: where offsets are compared; by default `frame_of` the case.

    Raises:
        InvalidArgumentError: no answer, or no truth.
    """
    frame = frame_of(prediction.case) if frame is None else frame
    if not len(prediction.ranking.offsets) or not prediction.case.planes:
        raise InvalidArgumentError(f"GTE of {prediction.case.name!r}: an answer and a truth are needed")
    normals, offsets = frame.of(prediction.answers)
    plain = float(plane_distance(*frame.of(prediction.truths), normals[0], offsets[0]).min())
    return GroundTruthError(plain**2, plain)
