"""The estimator's pairs, from the caller's arrays to the solvers.

`arguments` checks what is given, `padded` pads it to one of few sizes, and `normalized` centres and scales it to unit
radius. `precision` lets float64 arrays of NumPy be computed in float64 whatever JAX's flags are.
"""
