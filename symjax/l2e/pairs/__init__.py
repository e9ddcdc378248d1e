"""The estimator's pairs, from the caller's arrays to the solvers.

`arguments` checks what is given, `padded` pads it to one of few sizes, and `normalised` centres and scales it to unit
radius.
"""
