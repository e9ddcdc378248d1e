"""What the estimator asks of its arguments, checked before anything is traced.

Shapes and types are always checked. Values are checked where they are known: an argument that is being traced
(under jit, vmap or grad) passes.
"""

from collections.abc import Iterable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float

from symjax.errors import InvalidArgumentError, InvalidPointsError, NonfiniteError, TooFewPointsError
from symjax.geometry.arrays import AnyArray

UNIT_TOLERANCE = 1e-3  # how far from 1 the length of a start may be
MIN_PAIRS = 3

AnyPairs = Float[AnyArray, "n 3"]


def _known(value: Any) -> bool:
    return not isinstance(value, jax.core.Tracer)


def _as_array(value: Any, name: str, error: type[ValueError], *, mask: bool = False) -> Any:
    """The argument as an array of real numbers (or a mask): NumPy's unless it is being traced."""
    if _known(value):
        try:
            value = np.asarray(value)
        except ValueError as problem:
            raise error(f"{name} is ragged: give an array of numbers") from problem
    kinds = [jnp.floating, jnp.integer] + [jnp.bool_] * mask
    if not any(jnp.issubdtype(value.dtype, kind) for kind in kinds):
        raise error(f"{name} has type {value.dtype}: give real numbers")
    return value


def checked_pairs(x: ArrayLike, y: ArrayLike) -> tuple[AnyPairs, AnyPairs]:
    """The two ends of the pairs as arrays of one floating type.

    Raises:
        InvalidPointsError: unless both have the same shape (n, 3) and hold real numbers.
        TooFewPointsError: for fewer than three pairs.
        NonfiniteError: for NaN or infinite coordinates.
    """
    ends = []
    for name, end in (("x", x), ("y", y)):
        end = _as_array(end, name, InvalidPointsError)
        if end.ndim != 2 or end.shape[1] != 3:
            hint = "; transpose it" if end.ndim == 2 and end.shape[0] == 3 else ""
            raise InvalidPointsError(f"{name} has shape {end.shape}, not (n, 3){hint}")
        if _known(end):
            finite = np.isfinite(np.asarray(end))
            if not finite.all():
                bad = np.flatnonzero(~finite.all(axis=1))
                raise NonfiniteError(
                    f"{name} has NaN or infinite coordinates in {len(bad)} of {len(end)} rows, the first is "
                    f"row {bad[0]}: drop those pairs from x and y"
                )
        if jnp.issubdtype(end.dtype, jnp.integer):
            end = end.astype(float)
        ends.append(end)
    if ends[0].shape != ends[1].shape:
        raise InvalidPointsError(
            f"x has shape {ends[0].shape} and y has shape {ends[1].shape}: y[i] is the mirror partner of x[i]"
        )
    if len(ends[0]) < MIN_PAIRS:
        raise TooFewPointsError(f"{len(ends[0])} pairs are too few: a plane takes {MIN_PAIRS} or more")
    # a half-precision type cannot hold the exponents
    dtype = jnp.result_type(*ends, jnp.float32)
    return ends[0].astype(dtype), ends[1].astype(dtype)


def checked_weights(weights: ArrayLike | None, num: int, dtype: Any) -> Float[AnyArray, "n"]:
    """The pairs' weights; ones for None.

    Raises:
        InvalidArgumentError: unless they are nonnegative, finite, not all zero, and one for each pair.
    """
    if weights is None:
        return np.ones(num, dtype)
    array = _as_array(weights, "weights", InvalidArgumentError, mask=True)
    if array.shape != (num,):
        raise InvalidArgumentError(f"weights has shape {array.shape}, not ({num},): one weight for each pair")
    if _known(array):
        values = np.asarray(array)
        bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0)))
        if len(bad):
            raise InvalidArgumentError(
                f"{len(bad)} weights are negative, NaN or infinite, the first is weights[{bad[0]}]"
            )
        if not values.any():
            raise InvalidArgumentError("every weight is zero")
    return array.astype(dtype)


def checked_name(argument: str, name: str, known: Iterable[str]) -> None:
    """Refuses a name that is not known.

    Raises:
        InvalidArgumentError: naming those that are.
    """
    if name not in (names := list(known)):
        raise InvalidArgumentError(f"{argument} {name!r} is unknown: choose one of {', '.join(names)}")


def checked_sigmas(sigmas: Any, ndim: int, dtype: Any) -> Float[Array, "*s"]:
    """σ, a scalar (ndim 0) or a row of them (ndim 1).

    Raises:
        InvalidArgumentError: unless of that many axes, positive and finite.
    """
    name = "sigmas" if ndim else "sigma"
    array = _as_array(sigmas, name, InvalidArgumentError)
    if array.ndim != ndim or array.size == 0:
        raise InvalidArgumentError(f"{name} has shape {array.shape}, not {'(S,)' if ndim else '()'}")
    if _known(array):
        values = np.asarray(array)
        if not (np.isfinite(values) & (values > 0)).all():
            raise InvalidArgumentError(f"{name} must be positive and finite, in the units of the points, not {values}")
    return jnp.asarray(array, dtype)


def checked_normals(normals: ArrayLike, ndim: int, dtype: Any) -> Float[Array, "*r 3"]:
    """Starting normals, one (ndim 1) or a row of them (ndim 2).

    Raises:
        InvalidArgumentError: unless of shape (3,) or (R, 3), finite, and unit to 1e-3.
    """
    name = "v0s" if ndim == 2 else "v0"
    array = _as_array(normals, name, InvalidArgumentError)
    if array.ndim != ndim or array.shape[-1] != 3 or array.size == 0:
        raise InvalidArgumentError(f"{name} has shape {array.shape}, not {'(R, 3)' if ndim == 2 else '(3,)'}")
    if _known(array):
        length = np.linalg.norm(np.asarray(array, float).reshape(-1, 3), axis=1)
        bad = np.flatnonzero(~(np.abs(length - 1) <= UNIT_TOLERANCE))
        if len(bad):
            raise InvalidArgumentError(
                f"{len(bad)} of {len(length)} starting normals are not of unit length, the first is number "
                f"{bad[0]} with length {length[bad[0]]:.6g}: divide each by its length"
            )
    return jnp.asarray(array, dtype)
