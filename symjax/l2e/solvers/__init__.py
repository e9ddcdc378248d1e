"""The solvers of the estimator, with one interface for one start or thousands of them.

A `base.Solver` consists of four functions: `init`, `should_continue`, `step` and `finish`. `base.solve` runs any solver
from one start, and `batched` runs many solves together.

`newton` is the default. `irls` is iteratively reweighted least squares, `rbfgs` (with its `line_search`) the paper's
Riemannian BFGS, `alternating` the paper's Algorithm 1, and `external` an optimistix minimiser. `registry` maps the
names in `names` to solvers. `small_eigh` computes eigenvalues of batches of 3 × 3 matrices.
"""
