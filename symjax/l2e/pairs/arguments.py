"""Checks of the estimator's arguments, made before anything is traced.

Shapes and types are always checked. Values are checked unless the argument is traced (under jit, vmap or grad). Arrays
on a device are checked on the device: only the number of bad rows is copied to the host.
"""

from collections.abc import Callable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Bool, Float, Int, Real, Shaped

from symjax.errors import InvalidArgumentError, InvalidPointsError, NonfiniteError, TooFewPointsError
from symjax.geometry.arrays import AnyArray
from symjax.l2e.jax_config import jit

UNIT_TOLERANCE = 1e-3  # largest deviation of the length of a starting normal from 1
MIN_PAIRS = 3
AUTO = "auto"

AnyPairs = Float[AnyArray, "n 3"]

Points = Real[AnyArray, "n 3"] | Sequence[Sequence[float]]
"""One end of the pairs, as given."""

AnyPoints = Real[AnyArray, "_ 3"] | Sequence[Sequence[float]]
"""The same, where several sets of pairs have different sizes."""

Weights = Shaped[AnyArray, " n"] | Sequence[float]
"""The weight of every pair, or a mask of the pairs to use."""

Sigma = Real[ArrayLike, ""] | str
"""σ, or "auto" to estimate σ together with the plane."""


def _known(value: Any) -> bool:
    return not isinstance(value, jax.core.Tracer)


def _on_device(value: Any) -> bool:
    """Returns whether NumPy would have to copy the value: it reads a JAX array on the CPU in place."""
    return isinstance(value, jax.Array) and _known(value) and any(d.platform != "cpu" for d in value.devices())


def _as_array(value: Any, name: str, error: type[ValueError], *, mask: bool = False) -> Any:
    """Converts an argument to an array of real numbers (or a mask), in NumPy unless it is traced or on a device."""
    if _known(value) and not _on_device(value):
        try:
            value = np.asarray(value)
        except ValueError as problem:
            raise error(f"{name} is ragged: pass an array of numbers") from problem
    kinds = [jnp.floating, jnp.integer] + [jnp.bool_] * mask
    if not any(jnp.issubdtype(value.dtype, kind) for kind in kinds):
        raise error(f"{name} has type {value.dtype}: pass real numbers")
    return value


IsBad = Callable[[AnyArray], Bool[AnyArray, " n"]]


def _nonfinite_rows(points: Real[AnyArray, "n 3"]) -> Bool[AnyArray, " n"]:
    xp: Any = points.__array_namespace__()
    bad: Bool[AnyArray, " n"] = ~xp.all(xp.isfinite(points), axis=1)
    return bad


def _invalid_weights(weights: Shaped[AnyArray, " n"]) -> Bool[AnyArray, " n"]:
    xp: Any = weights.__array_namespace__()
    bad: Bool[AnyArray, " n"] = ~(xp.isfinite(weights) & (weights >= 0))
    return bad


def _zero_weights(weights: Shaped[AnyArray, " n"]) -> Bool[AnyArray, " n"]:
    bad: Bool[AnyArray, " n"] = weights == 0
    return bad


def _not_unit_rows(normals: Real[AnyArray, "n 3"]) -> Bool[AnyArray, " n"]:
    xp: Any = normals.__array_namespace__()
    bad: Bool[AnyArray, " n"] = ~(xp.abs(xp.sqrt(xp.sum(normals**2, axis=1)) - 1) <= UNIT_TOLERANCE)
    return bad


@jit(static_argnames="is_bad")
def _count_and_first(is_bad: IsBad, rows: AnyArray) -> Int[Array, " 2"]:
    bad = is_bad(rows)
    return jnp.stack([jnp.sum(bad, dtype=jnp.int32), jnp.argmax(bad).astype(jnp.int32)])


def _bad(is_bad: IsBad, rows: AnyArray) -> tuple[int, int]:
    """Returns the number of bad rows and the index of the first. Traced rows count as good."""
    if not _known(rows):
        return 0, 0
    if _on_device(rows):
        count, first = np.asarray(_count_and_first(is_bad, rows)).tolist()
        return count, first
    bad = np.asarray(is_bad(rows))
    return int(bad.sum()), int(bad.argmax())


def checked_pairs(x: Points, y: Points) -> tuple[AnyPairs, AnyPairs]:
    """Converts the two ends of the pairs to arrays of one floating type.

    Raises:
        InvalidPointsError: if they do not have the same shape (n, 3), or do not hold real numbers.
        TooFewPointsError: if there are fewer than three pairs.
        NonfiniteError: if a coordinate is NaN or infinite.
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
                    f"row {first}: drop these pairs from x and y"
                )
        ends.append(end)
    if ends[0].shape != ends[1].shape:
        raise InvalidPointsError(
            f"x has shape {ends[0].shape} and y has shape {ends[1].shape}: y[i] must be the mirror image of x[i]"
        )
    if len(ends[0]) < MIN_PAIRS:
        raise TooFewPointsError(f"{len(ends[0])} pairs are too few to fit a plane: pass at least {MIN_PAIRS}")
    dtype = _floating(*(end.dtype for end in ends))
    return ends[0].astype(dtype), ends[1].astype(dtype)


def _floating(*dtypes: Any) -> Any:
    """Returns float64 for integers and types wider than float32, if JAX's flags allow it; else float32.

    Half precision is widened too, because it cannot hold the exponents.
    """
    wide = any(jnp.issubdtype(dtype, jnp.integer) or dtype.itemsize > 4 for dtype in dtypes)
    return jax.dtypes.canonicalize_dtype(np.float64 if wide else np.float32)


def checked_weights(weights: Weights | None, num: int, dtype: Any) -> Float[AnyArray, " n"]:
    """Converts the weights of the pairs to a floating array; None gives ones.

    Raises:
        InvalidArgumentError: if a weight is negative or not finite, if all are zero, or if their number is not `num`.
    """
    if weights is None:
        return np.ones(num, dtype)
    array = _as_array(weights, "weights", InvalidArgumentError, mask=True)
    if array.shape != (num,):
        raise InvalidArgumentError(f"weights has shape {array.shape}, not ({num},): pass one weight for each pair")
    count, first = _bad(_invalid_weights, array)
    if count:
        raise InvalidArgumentError(f"{count} weights are negative, NaN or infinite, the first is weights[{first}]")
    if _bad(_zero_weights, array)[0] == num:
        raise InvalidArgumentError("every weight is zero: at least one must be positive")
    checked: Float[AnyArray, " n"] = array.astype(dtype)
    return checked


def checked_sigma(sigma: Sigma, solver: Any, dtype: Any) -> Float[Array, ""] | None:
    """Converts σ to a scalar array; "auto" gives None.

    Raises:
        InvalidArgumentError: if σ is another string, if it is "auto" and the solver is not "newton", or if it is
            refused by `checked_sigmas`.
    """
    if isinstance(sigma, str):
        if sigma != AUTO:
            raise InvalidArgumentError(f"sigma must be a positive number or {AUTO!r}, got {sigma!r}")
        if solver != "newton":
            raise InvalidArgumentError(f"sigma={AUTO!r} is estimated with solver='newton' only, got {solver!r}")
        return None
    return checked_sigmas(sigma, 0, dtype)


def checked_sigmas(sigmas: Any, ndim: int, dtype: Any) -> Float[Array, "*s"]:
    """Converts scales σ to an array: a scalar (ndim 0) or a vector (ndim 1).

    Raises:
        InvalidArgumentError: if the number of axes is not `ndim`, or if a scale is not positive and finite.
    """
    name = "sigmas" if ndim else "sigma"
    array = _as_array(sigmas, name, InvalidArgumentError)
    if array.ndim != ndim or array.size == 0:
        raise InvalidArgumentError(f"{name} must have shape {'(S,)' if ndim else '()'}, got {array.shape}")
    if _known(array):
        values = np.asarray(array)
        if not (np.isfinite(values) & (values > 0)).all():
            raise InvalidArgumentError(f"{name} must be positive and finite, in the units of the points, got {values}")
    return jnp.asarray(array, dtype)


def checked_normals(normals: Real[AnyArray, "*r 3"] | Sequence[Any], ndim: int, dtype: Any) -> Float[Array, "*r 3"]:
    """Converts starting normals to an array: one (ndim 1) or a list of them (ndim 2).

    Raises:
        InvalidArgumentError: if the shape is not (3,) or (R, 3), or if a length differs from 1 by more than 1e-3.
    """
    name = "v0s" if ndim == 2 else "v0"
    array = _as_array(normals, name, InvalidArgumentError)
    if array.ndim != ndim or array.shape[-1] != 3 or array.size == 0:
        raise InvalidArgumentError(f"{name} must have shape {'(R, 3)' if ndim == 2 else '(3,)'}, got {array.shape}")
    rows = array.reshape(-1, 3)
    count, first = _bad(_not_unit_rows, rows)
    if count:
        length = np.linalg.norm(np.asarray(rows[first], float))
        if ndim == 1:
            raise InvalidArgumentError(f"{name} is not of unit length but {length:.6g}: divide it by its length")
        raise InvalidArgumentError(
            f"{count} of {len(rows)} starting normals are not of unit length, the first is {name}[{first}] with "
            f"length {length:.6g}: divide each by its length"
        )
    return jnp.asarray(array, dtype)
