"""Starts of the solvers, and the estimate of the scale σ.

`initialisation` computes one normal from all pairs: the paper's robust Grassmann average, the least principal
direction, or least squares. `hypotheses` takes the mirror plane of every single pair and ranks these by the criterion.
`scale_estimation` estimates σ and the inlier fraction together with the plane. `names` lists the starts by name.
"""
