"""Annotations for arrays of NumPy or JAX that do not import JAX."""

from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Array

    AnyArray: TypeAlias = Array | np.ndarray
else:
    # jaxtyping's `Array` would import JAX
    AnyArray = Any
"""A NumPy or JAX array."""

if TYPE_CHECKING:
    JitInput: TypeAlias = Array
else:
    JitInput = Any
"""A NumPy or JAX array that is passed to a compiled function. Inside, where it is used, it is a JAX array: its type."""
