"""The L2E estimator of the mirror plane of putative pairs (paper, Eq. 5): pairs in, `Fit` out, pure JAX between.

`fit_plane` fits from one start, `fit_global` looks for the best plane of all, `sweep` tries many scales σ and starts.
All go the same way: `pairs` checks, pads and normalises what is given, `starts` proposes planes, `objective`,
`features` and `criterion` define what is minimised, on `manifolds`, by one of the `solvers`; `fit` takes the
minimum back to the units of the points, with its derivatives (`implicit`). `standard_errors` says how sure a fit is,
`status` how a solve ended.
"""
