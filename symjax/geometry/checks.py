"""Checks of single options. They raise `InvalidArgumentError` before anything is computed."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from symjax.errors import InvalidArgumentError


def whole(name: str, value: Any, least: int) -> int:
    """Returns a whole number as an `int`.

    Args:
        name: name of the option in an error message.
        value: number of Python, NumPy or JAX.
        least: smallest valid number.

    Raises:
        InvalidArgumentError: if the value is not a whole number, or is smaller than `least`.
    """
    number = _python_scalar(value)
    if not isinstance(number, int) or isinstance(number, bool) or number < least:
        raise InvalidArgumentError(f"{name} must be a whole number, at least {least}, got {value!r}")
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
    """Returns a finite number within bounds as a `float`.

    Args:
        name: name of the option in an error message.
        value: number of Python, NumPy or JAX.
        least: smallest valid number.
        above: lower bound that is itself invalid.
        most: largest valid number.
        below: upper bound that is itself invalid.

    Raises:
        InvalidArgumentError: if the value is not a number, not finite, or out of the bounds.
    """
    found = _python_scalar(value)
    is_number = isinstance(found, (int, float)) and not isinstance(found, bool)
    if not is_number or not (least <= found <= most and above < found < below):
        bounds = {"at least": least, "above": above, "at most": most, "below": below}
        named = "".join(f", {word} {bound:g}" for word, bound in bounds.items() if math.isfinite(bound))
        raise InvalidArgumentError(f"{name} must be a finite number{named}, got {value!r}")
    return float(found)


def flag(name: str, value: Any) -> bool:
    """Returns True or False as a `bool`.

    Raises:
        InvalidArgumentError: if the value is neither.
    """
    if not isinstance(_python_scalar(value), bool):
        raise InvalidArgumentError(f"{name} must be True or False, got {value!r}")
    return bool(value)


def choice(name: str, value: Any, known: Iterable[str]) -> None:
    """Checks that a value is one of the known names.

    Raises:
        InvalidArgumentError: if it is not; the message lists the known names.
    """
    words = list(known)
    if not isinstance(value, str) or value not in words:
        raise InvalidArgumentError(f"{name} {value!r} is unknown: choose one of {', '.join(words)}")


def as_path(value: Any) -> Path:
    """Converts the name of a file or folder to a `Path`.

    Raises:
        InvalidArgumentError: if the value is neither text nor a path.
    """
    try:
        return Path(value)
    except TypeError as error:
        raise InvalidArgumentError(f"a path must be text or a pathlib.Path, got {value!r}") from error


def _python_scalar(value: Any) -> Any:
    """Converts a scalar of NumPy or JAX to a Python number; returns anything else unchanged."""
    return value.item() if getattr(value, "shape", None) == () else value
