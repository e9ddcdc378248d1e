"""Where solvers start, and the scale that they need.

`initialisation` computes one normal from all pairs (the paper's robust Grassmann average, the principal direction,
least squares); `hypotheses` takes every pair's own mirror plane and ranks them by the criterion; `scale_estimation`
finds σ and the share of mirror pairs with the plane, where σ is not given. `names` lists the starts by name.
"""
