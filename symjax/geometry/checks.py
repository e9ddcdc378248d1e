"""Checks of single options: what is out of its range is refused before anything is computed."""

import math
from collections.abc import Iterable
from typing import Any

from symjax.errors import InvalidArgumentError


def whole(name: str, value: Any, least: int) -> int:
    """A whole number.

    Raises:
        InvalidArgumentError: it is none, or smaller than `least`.
    """
    number = _scalar(value)
    if not isinstance(number, int) or isinstance(number, bool) or number < least:
        raise InvalidArgumentError(f"{name} must be a whole number, at least {least}, not {value!r}")
    return number


def number(
    name: str,
    value: Any,
    *,
    least: float = -math.inf,
    above: float = -math.inf,
    most: float = math.inf,
    below: float = math.inf,
) -> float:
    """A finite number, within the bounds.

    Raises:
        InvalidArgumentError: it is none, not finite, or out of the bounds.
    """
    found = _scalar(value)
    is_number = isinstance(found, (int, float)) and not isinstance(found, bool)
    if not is_number or not (least <= found <= most and above < found < below):
        bounds = {"at least": least, "above": above, "at most": most, "below": below}
        named = "".join(f", {word} {bound:g}" for word, bound in bounds.items() if math.isfinite(bound))
        raise InvalidArgumentError(f"{name} must be a finite number{named}, not {value!r}")
    return float(found)


def flag(name: str, value: Any) -> bool:
    """True or False.

    Raises:
        InvalidArgumentError: it is neither.
    """
    if not isinstance(_scalar(value), bool):
        raise InvalidArgumentError(f"{name} must be True or False, not {value!r}")
    return bool(value)


def choice(name: str, value: Any, known: Iterable[str]) -> None:
    """Refuses a word that is not known.

    Raises:
        InvalidArgumentError: naming those that are.
    """
    words = list(known)
    if not isinstance(value, str) or value not in words:
        raise InvalidArgumentError(f"{name} {value!r} is unknown: choose one of {', '.join(words)}")


def _scalar(value: Any) -> Any:
    """A number of NumPy or JAX as one of Python."""
    return value.item() if getattr(value, "shape", None) == () else value
