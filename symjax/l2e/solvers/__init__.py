"""The solvers of the estimator: one interface, one loop, one plane or thousands of them at a time.

A `base.Solver` is four functions (begin, go on, step, finish), so that `solve` runs any of them from one start and
`batched` runs many together. `newton` is the default, `irls` the reweighted least squares beside it, `rbfgs` (with its
`line_search`) the paper's Riemannian BFGS, `alternating` its Algorithm 1, `external` a minimiser of optimistix;
`registry` finds them by the names in `names`. `small_eigh` computes eigenvalues of 3 × 3 matrices by the batch.
"""
