"""Timings that can be compared: the cases take turns in one run, since machines are shared and noisy."""

from collections.abc import Callable, Mapping
from time import perf_counter
from typing import Any

import jax
import numpy as np
from jaxtyping import Float
from tqdm import trange

Case = Callable[[], Any]


def interleaved(cases: Mapping[str, Case], repeats: int) -> dict[str, Float[np.ndarray, " r"]]:
    """Seconds of every case in every round; all are called once before, which compiles.

    Args:
        cases: by name, what is timed; JAX arrays that it returns are waited for.
        repeats: number of rounds.
    """
    for case in cases.values():
        jax.block_until_ready(case())
    seconds: dict[str, list[float]] = {name: [] for name in cases}
    for _ in trange(repeats, disable=None, leave=False):
        for name, case in cases.items():
            start = perf_counter()
            jax.block_until_ready(case())
            seconds[name].append(perf_counter() - start)
    return {name: np.asarray(times) for name, times in seconds.items()}


def ratio(slow: Float[np.ndarray, " r"], fast: Float[np.ndarray, " r"]) -> tuple[float, str]:
    """How many times slower one case is than another: median over the rounds, and its quartiles as text."""
    low, middle, high = np.quantile(slow / fast, [0.25, 0.5, 0.75])
    return float(middle), f"{low:.3g}-{high:.3g}"
