"""The L2E estimator of the mirror plane of putative pairs (paper, Eq. 5): takes pairs, returns a `Fit`, in pure JAX.

`fit_plane` fits from one start, `fit_global` searches for the best plane without a start, and `sweep` fits for many
scales σ and starts. All of them share these stages:

1. `pairs` checks, pads and normalises the arguments.
2. `starts` proposes planes.
3. One of the `solvers` minimises the `criterion` (computed from `features`; `objective` is the direct form) on one of
   the `manifolds`.
4. `fit` converts the minimum to the units of the points and attaches its derivatives (`implicit`).

`standard_errors` estimates the uncertainty of a fit, and `status` describes how a solve ended.
"""
