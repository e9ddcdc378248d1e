"""The scales of a sweep, as they are typed."""

import math
from typing import Any

import click

MOST = 10_000
"""Scales that one sweep may have."""


class Sigmas(click.ParamType):
    """`first:last:count`, in equal ratios; or a list separated by commas. Sorted, no value twice."""

    name = "sigmas"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, ...]:
        """The scales, positive and finite."""
        if not isinstance(value, str):
            return tuple(value)
        try:
            sigmas = _spaced(*value.split(":")) if ":" in value else [float(cell) for cell in value.split(",")]
        except (ValueError, TypeError, OverflowError):
            self.fail(f"{value!r} is neither FIRST:LAST:COUNT nor a list such as 0.01,0.02,0.05", param, ctx)
        for sigma in sigmas:
            if not (math.isfinite(sigma) and sigma > 0):
                self.fail(f"{sigma:g} is no scale: give positive fractions of the diagonal", param, ctx)
        return tuple(sorted(set(sigmas)))


def _spaced(first: str, last: str, count: str) -> list[float]:
    low, high, number = float(first), float(last), int(count)
    if not 1 <= number <= MOST:
        raise ValueError(f"{number} scales")
    if number == 1 or not (low > 0 and high > 0):
        return [low, high][:number]
    return [low * (high / low) ** (step / (number - 1)) for step in range(number - 1)] + [high]
