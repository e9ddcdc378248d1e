"""How a solve ended, as a number and as a sentence. No JAX is needed to read it."""

from enum import IntEnum

import numpy as np
from jaxtyping import Int


class Status(IntEnum):
    """The ways a solve can end: inside traced code a member is its number, an int32."""

    sentence: str
    """What it means, and what to do."""

    def __new__(cls, code: int, sentence: str = "") -> "Status":
        """A member is made of its number and its sentence."""
        member = int.__new__(cls, code)
        member._value_ = code
        member.sentence = sentence
        return member

    SUCCESSFUL = 0, "Converged: the Riemannian gradient is within tol."
    MAX_STEPS_REACHED = (
        1,
        "Not converged: max_steps was reached with the gradient above tol. Raise max_steps, or start nearer (v0).",
    )
    STALLED = (
        2,
        "Not converged: no lower loss was found with the gradient above tol. "
        "The tolerance may be below the rounding of the points in their precision: raise tol or use float64.",
    )
    FLAT = (
        3,
        "Not converged: at the answer every pair's weight exp(-f/2 sigma^2) underflows to exactly zero, so "
        "no pair supports the plane. Raise sigma, or start elsewhere (v0).",
    )
    NONFINITE = 4, "Not converged: the loss or its gradient is NaN or infinite. Check the pairs and sigma."
    UNSUPPORTED = (
        5,
        "Not enough mirror pairs: with sigma estimated, fewer than 20 pairs support the plane, and so few agree with "
        "some plane by chance. Give sigma, or more pairs.",
    )


SENTENCES = np.array([member.sentence for member in Status])
"""The sentence of every number."""


def sentences(codes: Int[np.ndarray, "*batch"] | int) -> str | np.ndarray:
    """The sentence of a number; of a batch of numbers, an array of sentences."""
    found = SENTENCES[np.asarray(codes)]
    return str(found) if found.ndim == 0 else found
