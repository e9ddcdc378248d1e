"""The methods whose answers are judged as they stand: ours, the paper's, and the one other package."""

from time import perf_counter
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.baselines.registry import ENTRIES, OURS, PEER, usable
from symjax.geometry.plane import Plane

__all__ = ["METHODS", "PEER", "Answer", "answer", "usable"]

METHODS = (OURS, "sym-hks-printed", "sym-hks", "sym-hks-cleaned", PEER)
"""By their names in `ENTRIES`; robustness and ablation compare these."""


class Answer(NamedTuple):
    """What a method says of a cloud.

    Attributes:
        plane: the plane; None where the method gave up.
        found: whether the method takes it for a symmetry.
        ambiguous: whether it says that others are as good.
        seconds: that it took.
        error: why it gave up.
    """

    plane: Plane | None
    found: bool
    ambiguous: bool
    seconds: float
    error: str = ""


def answer(method: str, points: Float[np.ndarray, "n 3"]) -> Answer:
    """What a method says of a cloud. One that raises has given no answer, whatever it raises."""
    start = perf_counter()
    try:
        said = ENTRIES[method].propose(points, np.random.default_rng(0))
    except Exception as error:
        return Answer(None, False, False, perf_counter() - start, repr(error))
    return Answer(said.ranking.plane(), said.found, said.ambiguous, perf_counter() - start)
