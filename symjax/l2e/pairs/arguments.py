"""What the estimator asks of its arguments, checked before anything is traced.

Shapes and types are always checked. Values are checked where they are known: an argument that is being traced
(under jit, vmap or grad) passes. What lies on a device is looked at there: only the count of bad rows comes back.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float, Int, Real, Shaped

from symjax.errors import InvalidArgumentError, InvalidPointsError, NonfiniteError, TooFewPointsError
from symjax.geometry.arrays import AnyArray

UNIT_TOLERANCE = 1e-3  # how far from 1 the length of a start may be
MIN_PAIRS = 3
AUTO = "auto"

AnyPairs = Float[AnyArray, "n 3"]

Points = Real[AnyArray, "n 3"] | Sequence[Sequence[float]]
"""One end of the pairs, as given."""

Weights = Shaped[AnyArray, " n"] | Sequence[float]
"""A weight of every pair, or whether it is used."""

Sigma = Real[ArrayLike, ""] | str
"""σ, or "auto" for σ estimated with the plane."""


def _known(value: Any) -> bool:
    return not isinstance(value, jax.core.Tracer)


def _on_device(value: Any) -> bool:
    """Whether the value would be copied to be looked at: the host sees an array of the CPU as it is."""
    return isinstance(value, jax.Array) and _known(value) and any(d.platform != "cpu" for d in value.devices())


def _as_array(value: Any, name: str, error: type[ValueError], *, mask: bool = False) -> Any:
    """The argument as an array of real numbers (or a mask): NumPy's unless it is being traced or on a device."""
    if _known(value) and not _on_device(value):
        try:
            value = np.asarray(value)
        except ValueError as problem:
            raise error(f"{name} is ragged: give an array of numbers") from problem
    kinds = [jnp.floating, jnp.integer] + [jnp.bool_] * mask
    if not any(jnp.issubdtype(value.dtype, kind) for kind in kinds):
        raise error(f"{name} has type {value.dtype}: give real numbers")
    return value


IsBad = Callable[[AnyArray], Bool[AnyArray, " n"]]


def _nonfinite_rows(points: Float[AnyArray, "n 3"]) -> Bool[AnyArray, " n"]:
    xp: Any = points.__array_namespace__()
    return ~xp.all(xp.isfinite(points), axis=1)


def _not_a_weight(weights: Float[AnyArray, " n"]) -> Bool[AnyArray, " n"]:
    xp: Any = weights.__array_namespace__()
    return ~(xp.isfinite(weights) & (weights >= 0))


def _is_zero(weights: Float[AnyArray, " n"]) -> Bool[AnyArray, " n"]:
    return weights == 0


def _not_of_unit_length(normals: Float[AnyArray, "n 3"]) -> Bool[AnyArray, " n"]:
    xp: Any = normals.__array_namespace__()
    return ~(xp.abs(xp.sqrt(xp.sum(normals**2, axis=1)) - 1) <= UNIT_TOLERANCE)


@partial(jax.jit, static_argnames="is_bad")
def _count_and_first(is_bad: IsBad, rows: AnyArray) -> Int[Array, " 2"]:
    bad = is_bad(rows)
    return jnp.stack([jnp.sum(bad, dtype=jnp.int32), jnp.argmax(bad).astype(jnp.int32)])


def _bad(is_bad: IsBad, rows: AnyArray) -> tuple[int, int]:
    """How many rows are bad, and the first of them; of what is traced, none."""
    if not _known(rows):
        return 0, 0
    if _on_device(rows):
        count, first = np.asarray(_count_and_first(is_bad, rows)).tolist()
        return count, first
    bad = np.asarray(is_bad(rows))
    return int(bad.sum()), int(bad.argmax())


def checked_pairs(x: Points, y: Points) -> tuple[AnyPairs, AnyPairs]:
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
        if len(end):
            count, first = _bad(_nonfinite_rows, end)
            if count:
                raise NonfiniteError(
                    f"{name} has NaN or infinite coordinates in {count} of {len(end)} rows, the first is "
                    f"row {first}: drop those pairs from x and y"
                )
        ends.append(end)
    if ends[0].shape != ends[1].shape:
        raise InvalidPointsError(
            f"x has shape {ends[0].shape} and y has shape {ends[1].shape}: y[i] is the mirror partner of x[i]"
        )
    if len(ends[0]) < MIN_PAIRS:
        raise TooFewPointsError(f"{len(ends[0])} pairs are too few: a plane takes {MIN_PAIRS} or more")
    dtype = _floating(*(end.dtype for end in ends))
    return ends[0].astype(dtype), ends[1].astype(dtype)


def _floating(*dtypes: Any) -> Any:
    """float64 for integers and whatever holds more than float32, where JAX's flags allow it; else float32.

    A half-precision type cannot hold the exponents.
    """
    wide = any(jnp.issubdtype(dtype, jnp.integer) or dtype.itemsize > 4 for dtype in dtypes)
    return jax.dtypes.canonicalize_dtype(np.float64 if wide else np.float32)


def checked_weights(weights: Weights | None, num: int, dtype: Any) -> Float[AnyArray, " n"]:
    """The pairs' weights; ones for None.

    Raises:
        InvalidArgumentError: unless they are nonnegative, finite, not all zero, and one for each pair.
    """
    if weights is None:
        return np.ones(num, dtype)
    array = _as_array(weights, "weights", InvalidArgumentError, mask=True)
    if array.shape != (num,):
        raise InvalidArgumentError(f"weights has shape {array.shape}, not ({num},): one weight for each pair")
    count, first = _bad(_not_a_weight, array)
    if count:
        raise InvalidArgumentError(f"{count} weights are negative, NaN or infinite, the first is weights[{first}]")
    if _bad(_is_zero, array)[0] == num:
        raise InvalidArgumentError("every weight is zero")
    return array.astype(dtype)


def checked_sigma(sigma: Sigma, solver: Any, dtype: Any) -> Float[Array, ""] | None:
    """σ; None for "auto".

    Raises:
        InvalidArgumentError: for another word, for "auto" with another solver than "newton", and see `checked_sigmas`.
    """
    if isinstance(sigma, str):
        if sigma != AUTO:
            raise InvalidArgumentError(f"sigma must be a positive number or {AUTO!r}, not {sigma!r}")
        if solver != "newton":
            raise InvalidArgumentError(f"sigma={AUTO!r} is estimated with solver='newton', not {solver!r}")
        return None
    return checked_sigmas(sigma, 0, dtype)


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


def checked_normals(normals: Real[AnyArray, "*r 3"] | Sequence[Any], ndim: int, dtype: Any) -> Float[Array, "*r 3"]:
    """Starting normals, one (ndim 1) or a row of them (ndim 2).

    Raises:
        InvalidArgumentError: unless of shape (3,) or (R, 3), finite, and unit to 1e-3.
    """
    name = "v0s" if ndim == 2 else "v0"
    array = _as_array(normals, name, InvalidArgumentError)
    if array.ndim != ndim or array.shape[-1] != 3 or array.size == 0:
        raise InvalidArgumentError(f"{name} has shape {array.shape}, not {'(R, 3)' if ndim == 2 else '(3,)'}")
    rows = array.reshape(-1, 3)
    count, first = _bad(_not_of_unit_length, rows)
    if count:
        length = np.linalg.norm(np.asarray(rows[first], float))
        raise InvalidArgumentError(
            f"{count} of {len(rows)} starting normals are not of unit length, the first is number {first} with "
            f"length {length:.6g}: divide each by its length"
        )
    return jnp.asarray(array, dtype)
