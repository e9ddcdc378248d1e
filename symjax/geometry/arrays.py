"""An annotation for arrays of NumPy or JAX that does not import JAX."""

from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Array

    AnyArray: TypeAlias = Array | np.ndarray
else:
    # jaxtyping's `Array` would import JAX
    AnyArray = Any
"""A NumPy or JAX array."""
