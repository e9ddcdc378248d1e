"""The estimator's pairs, from the caller's arrays to the solvers and back.

`arguments` checks what is given, `padded` pads it to one of few sizes, `normalized` centres and scales it to unit
radius, and `unscale` takes a minimum back to the units of the points. `precision` lets float64 arrays of NumPy be
computed in float64 whatever JAX's flags are.
"""
