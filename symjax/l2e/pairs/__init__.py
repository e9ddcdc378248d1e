"""The estimator's pairs, from the caller's arrays to the form that the solvers take.

`arguments` checks the arrays, `padded` pads them to one of few sizes, and `normalised` centres them and scales them to
unit radius.
"""
