"""How a solver ended, as a number and as a sentence. This module does not import JAX."""

from enum import IntEnum

import numpy as np
from jaxtyping import Int

from symjax.geometry.arrays import AnyArray


class Status(IntEnum):
    """The ways a solver can end. Traced code holds a member as its number, an int32."""

    sentence: str
    """What the status means, and what to do about it."""

    def __new__(cls, code: int, sentence: str = "") -> "Status":
        """Makes a member from its number and its sentence."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.sentence = sentence
        return member

    SUCCESSFUL = 0, "Converged: the Riemannian gradient is within tol."
    MAX_STEPS_REACHED = (
        1,
        "Not converged: max_steps was reached with the gradient above tol. Raise max_steps, or start closer (v0).",
    )
    STALLED = (
        2,
        "Not converged: no lower loss was found although the gradient is above tol. "
        "The tolerance may be below the rounding error of the points: raise tol or use float64.",
    )
    FLAT = (
        3,
        "Not converged: at the result every pair's weight exp(-f/2 sigma^2) underflows to exactly zero, so "
        "no pair supports the plane. Raise sigma, or start elsewhere (v0).",
    )
    NONFINITE = 4, "Not converged: the loss or its gradient is NaN or infinite. Check the pairs and sigma."
    UNSUPPORTED = (
        5,
        "Too few inliers: sigma was estimated and fewer than 20 pairs support the plane. That few agree with some "
        "plane by chance. Give sigma, or more pairs.",
    )


SENTENCES = np.array([member.sentence for member in Status])
"""The sentences, indexed by the numbers."""


def sentences(codes: Int[AnyArray, "*batch"] | int) -> str | np.ndarray:
    """Returns the sentence of a status; for a batch, an array of sentences."""
    found = SENTENCES[np.asarray(codes)]
    return str(found) if found.ndim == 0 else found
