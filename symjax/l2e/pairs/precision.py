"""float64 pairs are computed in float64, whatever JAX's flags are."""

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

P = ParamSpec("P")
R = TypeVar("R")


def float64_as_given(function: Callable[P, R]) -> Callable[P, R]:
    """Lets a function of pairs `x` and `y` compute in float64 where one of them is float64 and nothing is traced.

    Lists and integers count as float64. JAX's x64 flag is set during the call only. Since JAX would cut float64 to
    float32 in the next operation, the answer is then made of NumPy arrays.
    """
    signature = inspect.signature(function)

    @wraps(function)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        if jax.dtypes.canonicalize_dtype(np.float64) == np.float64:
            return function(*args, **kwargs)
        given = signature.bind(*args, **kwargs).arguments
        if not (_is_float64(given["x"]) or _is_float64(given["y"])) or _is_traced(given):
            return function(*args, **kwargs)
        with jax.enable_x64(True):
            answer = function(*args, **kwargs)
            return jax.tree.map(lambda leaf: np.asarray(leaf) if isinstance(leaf, jax.Array) else leaf, answer)

    return wrapped


def _is_float64(points: Any) -> bool:
    try:
        dtype = points.dtype if hasattr(points, "dtype") else np.asarray(points).dtype
    except ValueError:
        return False  # ragged: refused where arguments are checked
    if isinstance(points, jax.Array):
        return bool(dtype == np.float64)
    return bool(np.issubdtype(dtype, np.integer) or (np.issubdtype(dtype, np.floating) and dtype.itemsize >= 8))


def _is_traced(given: dict[str, Any]) -> bool:
    """Whether an argument is traced, or the call itself is: under jit even a constant is traced."""
    leaves = [*jax.tree.leaves(given), jnp.zeros(())]
    return any(isinstance(leaf, jax.core.Tracer) for leaf in leaves)
