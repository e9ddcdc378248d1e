"""Solvers of other packages on the estimator's problem: each runs from many starts and returns the lowest ψ."""

import importlib.util
from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import scipy.optimize
from jaxtyping import Array, Float

from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.objective import scaled_log_loss
from symjax.l2e.pairs.normalised import NormalisedPairs
from symjax.l2e.solvers.rbfgs import minimise


class Task(NamedTuple):
    """A problem and its starts.

    Attributes:
        pairs: centred and scaled pairs.
        sigma: scale σ, in the units of the scaled pairs.
        starts: starts (v, ω).
        max_steps: limit on the steps from each start.
        tol: bound on the gradient.
    """

    pairs: NormalisedPairs
    sigma: Float[Array, ""]
    starts: Float[Array, "r 4"]
    max_steps: int
    tol: float

    def psi(self, z: Float[Array, " 4"]) -> Float[Array, ""]:
        """ψ of a plane, computed directly from the residuals."""
        return scaled_log_loss(z[:3], z[3], self.sigma, self.pairs.x, self.pairs.y)

    def unconstrained(self, z: Float[Array, " 4"]) -> Float[Array, ""]:
        """ψ after normalisation of the normal, for solvers without a sphere constraint."""
        return self.psi(z.at[:3].divide(jnp.sqrt(jnp.sum(z[:3] ** 2))))

    def solve(self, start: Float[Array, " 4"]) -> Float[Array, ""]:
        """ψ that Riemannian BFGS reaches from a start."""
        value: Float[Array, ""] = minimise(
            self.psi, start, manifold=SPHERE_LINE, max_steps=self.max_steps, tol=self.tol
        ).value
        return value


OFFSETS = 31

Lowest = Callable[[], Any]
"""Runs a solver from all starts and returns the lowest ψ."""


def naive(task: Task) -> Lowest:
    """Returns symjax's Riemannian BFGS on the residuals, with all starts under one vmap, like the first `sweep`."""
    run = jax.jit(lambda starts: jnp.min(jax.vmap(task.solve)(starts)))
    return lambda: run(task.starts)


def naive_from_normals(task: Task) -> Lowest:
    """Returns `naive`, but from normals; the offset is the best of 31 quantiles of the mid-points along the normal."""
    x, y = task.pairs.x, task.pairs.y
    shares = jnp.asarray((np.arange(OFFSETS) + 0.5) / OFFSETS, x.dtype)

    def solve(v: Float[Array, " 3"]) -> Float[Array, ""]:
        offsets = jnp.quantile(jnp.sum(0.5 * (x + y) * v[None, :], axis=1), shares)
        values = jax.vmap(lambda omega: task.psi(jnp.append(v, omega)))(offsets)
        return task.solve(jnp.append(v, offsets[jnp.argmin(values)]))

    run = jax.jit(lambda normals: jnp.min(jax.vmap(solve)(normals)))
    return lambda: run(task.starts[:, :3])


def with_optimistix(task: Task) -> Lowest:
    """Returns the BFGS of optimistix, with all starts under one vmap."""
    import optimistix as optx

    solver: Any = optx.BFGS(rtol=task.tol, atol=task.tol)

    def solve(start: Float[Array, " 4"]) -> Float[Array, ""]:
        solution: Any = optx.minimise(
            lambda z, _: task.unconstrained(z), solver, start, max_steps=task.max_steps, throw=False
        )
        return task.unconstrained(solution.value)

    run = jax.jit(lambda starts: jnp.nanmin(jax.vmap(solve)(starts)))
    return lambda: run(task.starts)


def with_scipy(task: Task) -> Lowest:
    """Returns the BFGS of SciPy, one start after the other, on a compiled value and gradient."""
    compiled = jax.jit(jax.value_and_grad(task.unconstrained))

    def fun(z: Float[np.ndarray, " 4"]) -> tuple[float, Float[np.ndarray, " 4"]]:
        value, gradient = compiled(z)
        return float(value), np.asarray(gradient, float)

    options = {"gtol": task.tol, "maxiter": task.max_steps}

    def run() -> float:
        solutions = (scipy.optimize.minimize(fun, z, jac=True, method="BFGS", options=options) for z in starts)
        return min(float(solution.fun) for solution in solutions)

    starts = np.asarray(task.starts, float)
    return run


def with_pymanopt(task: Task, optimiser: str) -> Lowest:
    """Returns a solver of pymanopt on S² × R, one start after the other, on a compiled value and gradient."""
    import pymanopt
    from pymanopt.manifolds import Euclidean, Product, Sphere

    manifold = Product([Sphere(3), Euclidean(1)])
    compiled = jax.jit(jax.value_and_grad(task.psi))
    hessian_product = jax.jit(lambda z, step: jax.jvp(jax.grad(task.psi), (z,), (step,))[1])

    def cost(v: Float[np.ndarray, " 3"], omega: Float[np.ndarray, " 1"]) -> float:
        return float(compiled(np.append(v, omega))[0])

    def gradient(v: Float[np.ndarray, " 3"], omega: Float[np.ndarray, " 1"]) -> list[Float[np.ndarray, " _"]]:
        grad = np.asarray(compiled(np.append(v, omega))[1], float)
        return [grad[:3], grad[3:]]

    def hessian(*point_and_step: Float[np.ndarray, " _"]) -> list[Float[np.ndarray, " _"]]:
        z, step = np.concatenate(point_and_step[:2]), np.concatenate(point_and_step[2:])
        product = np.asarray(hessian_product(z, step), float)
        return [product[:3], product[3:]]

    as_numpy = pymanopt.function.numpy(manifold)
    problem = pymanopt.Problem(
        manifold, as_numpy(cost), euclidean_gradient=as_numpy(gradient), euclidean_hessian=as_numpy(hessian)
    )
    options = {"max_iterations": task.max_steps, "min_gradient_norm": task.tol, "verbosity": 0}
    starts = np.asarray(task.starts, float)

    def run() -> float:
        solver = getattr(pymanopt.optimizers, optimiser)(**options)
        return min(float(solver.run(problem, initial_point=[z[:3], z[3:]]).cost) for z in starts)

    return run


def available(task: Task) -> dict[str, Lowest]:
    """Returns the solvers of the installed packages by name."""
    solvers = {"optimistix BFGS, vmapped": with_optimistix(task), "SciPy BFGS, a loop": with_scipy(task)}
    if importlib.util.find_spec("pymanopt"):
        solvers |= {
            f"pymanopt {name}, a loop": with_pymanopt(task, name) for name in ("ConjugateGradient", "TrustRegions")
        }
    return solvers
