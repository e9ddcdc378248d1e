"""JAX's configuration: typed decorators, float64 for float64 pairs, and the persistent compilation cache."""

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from symjax.errors import InvalidArgumentError
from symjax.geometry.checks import as_path
from symjax.io.cache_folder import cache_folder

P = ParamSpec("P")
R = TypeVar("R")


def jit(*, static_argnames: str | Sequence[str] = ()) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Decorates like `jax.jit`, and keeps the signature of the function for type checkers."""

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        compiled: Callable[P, R] = jax.jit(function, static_argnames=static_argnames)
        return compiled

    return decorate


def full_precision(function: Callable[P, R]) -> Callable[P, R]:
    """Computes the function's matrix products in full precision: GPUs compute those of float32 in TF32 by default."""
    decorated: Callable[P, R] = jax.default_matmul_precision("highest")(function)
    return decorated


def keep_float64(function: Callable[P, R]) -> Callable[P, R]:
    """Makes a function of pairs `x` and `y` compute in float64 if either is float64 and no argument is traced.

    Lists and integers count as float64. JAX's x64 flag is set only during the call. The result then consists of NumPy
    arrays, because JAX would cut float64 to float32 in the next operation.
    """
    signature = inspect.signature(function)

    @wraps(function)
    def wrapped(*args: P.args, **kwargs: P.kwargs) -> R:
        if jax.dtypes.canonicalize_dtype(np.float64) == np.float64:
            return function(*args, **kwargs)
        arguments = signature.bind(*args, **kwargs).arguments
        if not (_is_float64(arguments["x"]) or _is_float64(arguments["y"])) or _is_traced(arguments):
            return function(*args, **kwargs)
        with jax.enable_x64(True):
            result = function(*args, **kwargs)
            on_host: R = jax.tree.map(lambda leaf: np.asarray(leaf) if isinstance(leaf, jax.Array) else leaf, result)
            return on_host

    return wrapped


def _is_float64(points: Any) -> bool:
    try:
        dtype = points.dtype if hasattr(points, "dtype") else np.asarray(points).dtype
    except ValueError:
        return False  # ragged: `symjax.l2e.pairs.arguments` raises the error
    if isinstance(points, jax.Array):
        return bool(dtype == np.float64)
    return bool(np.issubdtype(dtype, np.integer) or (np.issubdtype(dtype, np.floating) and dtype.itemsize >= 8))


def _is_traced(arguments: dict[str, Any]) -> bool:
    """Returns whether an argument or the call itself is traced: under jit even a new constant is a tracer."""
    leaves = [*jax.tree.leaves(arguments), jnp.zeros(())]
    return any(isinstance(leaf, jax.core.Tracer) for leaf in leaves)


def enable_compilation_cache(folder: str | Path | None = None) -> Path:
    """Stores all programs that JAX compiles from now on in a folder, and loads them from there in later processes.

    The first fit in a process takes seconds to compile; loading it takes a fraction of a second. The cache is off
    unless you call this function, because it changes JAX's configuration for the whole process.

    Args:
        folder: where to store the programs. By default $SYMJAX_CACHE if it is set, else `symjax` in the user's cache
            folder.

    Returns:
        The folder. It is created if necessary.

    Raises:
        InvalidArgumentError: if the folder cannot be created.

    Example:
        >>> import tempfile
        >>> import jax, symjax
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     symjax.enable_compilation_cache(folder).is_dir()
        True
        >>> jax.config.update("jax_compilation_cache_dir", None)  # turns the cache off again
    """
    path = cache_folder() if folder is None else as_path(folder)
    try:
        path = path.expanduser()
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError, ValueError) as error:
        raise InvalidArgumentError(f"cannot create the folder of compiled programs, {str(path)!r}: {error}") from error
    update: Callable[[str, Any], None] = jax.config.update
    update("jax_compilation_cache_dir", str(path))
    update("jax_persistent_cache_min_compile_time_secs", 0)
    update("jax_persistent_cache_min_entry_size_bytes", -1)
    return path
