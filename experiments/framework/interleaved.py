"""Comparable timings: the cases take turns in one process, because shared machines are noisy."""

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import jax
import numpy as np
from jaxtyping import Float
from tqdm import trange

Case = Callable[[], Any]

_wait: Callable[[Any], Any] = jax.block_until_ready  # JAX does not annotate it


def interleaved(cases: Mapping[str, Case], repeats: int) -> dict[str, Float[np.ndarray, " r"]]:
    """Times every case once per round, in turn, after one untimed call of each that compiles it.

    Args:
        cases: functions to time, by name. The clock stops when the JAX arrays that they return are ready.
        repeats: number of rounds.

    Returns:
        Seconds of every round, by the name of the case.
    """
    for case in cases.values():
        _wait(case())
    seconds: dict[str, list[float]] = {name: [] for name in cases}
    for _ in trange(repeats, disable=None, leave=False):
        for name, case in cases.items():
            start = perf_counter()
            _wait(case())
            seconds[name].append(perf_counter() - start)
    return {name: np.asarray(times) for name, times in seconds.items()}


def ratio(slow: Float[np.ndarray, " r"], fast: Float[np.ndarray, " r"]) -> tuple[float, str]:
    """Returns by what factor one case is slower than another: the median over the rounds, and the quartiles as text."""
    low, middle, high = np.quantile(slow / fast, [0.25, 0.5, 0.75])
    return float(middle), f"{low:.3g}-{high:.3g}"
