"""The option type for the scales σ of a sweep."""

import math
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    ParamType = click.ParamType[tuple[float, ...]]
else:
    ParamType = click.ParamType  # not generic in older versions of click

MAX_COUNT = 10_000
"""Limit on the number of scales in a range."""


class Sigmas(ParamType):
    """Scales as `FIRST:LAST:COUNT`, a geometric progression, or as a comma-separated list."""

    name = "sigmas"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, ...]:
        """Returns the scales in ascending order, without duplicates.

        Args:
            value: the text; or scales that were converted before.
            param: the option, for its name in an error.
            ctx: the command, for its name in an error.

        Raises:
            click.BadParameter: the text is not a range or a list, or a scale is not positive and finite.
        """
        if not isinstance(value, str):
            return tuple(value)
        try:
            sigmas = _spaced(*value.split(":")) if ":" in value else [float(cell) for cell in value.split(",")]
        except (ValueError, TypeError, OverflowError):
            self.fail(f"{value!r} is neither FIRST:LAST:COUNT nor a list such as 0.01,0.02,0.05", param, ctx)
        for sigma in sigmas:
            if not (math.isfinite(sigma) and sigma > 0):
                self.fail(f"a scale must be a positive, finite fraction of the diagonal, got {sigma:g}", param, ctx)
        return tuple(sorted(set(sigmas)))


def _spaced(first: str, last: str, count: str) -> list[float]:
    low, high, number = float(first), float(last), int(count)
    if not 1 <= number <= MAX_COUNT:
        raise ValueError(f"{number} scales")
    if number == 1 or not (low > 0 and high > 0):
        return [low, high][:number]
    return [low * (high / low) ** (step / (number - 1)) for step in range(number - 1)] + [high]
