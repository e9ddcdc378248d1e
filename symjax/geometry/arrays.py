"""The type of an array of NumPy or of JAX, for annotations that must not import JAX."""

from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Array

    AnyArray: TypeAlias = Array | np.ndarray
else:
    # jaxtyping's `Array` would import JAX
    AnyArray = Any
"""An array of JAX or of NumPy."""
