"""Other packages' solvers on the estimator's problem: from many starts to the lowest value of ψ that they find."""

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
    """A problem and where to start.

    Attributes:
        pairs: centred and scaled pairs.
        sigma: scale σ.
        starts: planes (v, ω).
        max_steps: limit on the steps of every solve.
        tol: bound on the gradient.
    """

    pairs: NormalisedPairs
    sigma: Float[Array, ""]
    starts: Float[Array, "r 4"]
    max_steps: int
    tol: float

    def psi(self, z: Float[Array, " 4"]) -> Float[Array, ""]:
        """The objective by the residuals as they are written."""
        return scaled_log_loss(z[:3], z[3], self.sigma, self.pairs.x, self.pairs.y)

    def free(self, z: Float[Array, " 4"]) -> Float[Array, ""]:
        """The same of a vector that is no unit normal yet, for solvers that know no sphere."""
        return self.psi(z.at[:3].divide(jnp.sqrt(jnp.sum(z[:3] ** 2))))


OFFSETS = 31

Lowest = Callable[[], Any]
"""Runs all starts and returns the lowest ψ."""


def naive(task: Task) -> Lowest:
    """Our Riemannian BFGS on the residuals as written, all starts under one vmap: what `sweep` was at first."""

    def one(start: Float[Array, " 4"]) -> Float[Array, ""]:
        solved = minimise(task.psi, start, manifold=SPHERE_LINE, max_steps=task.max_steps, tol=task.tol)
        return solved.value

    run = jax.jit(lambda starts: jnp.min(jax.vmap(one)(starts)))
    return lambda: run(task.starts)


def naive_from_normals(task: Task) -> Lowest:
    """The same from normals alone: the offset of each is the best of 31 quantiles of the mid-points' heights."""
    x, y = task.pairs.x, task.pairs.y
    shares = jnp.asarray((np.arange(OFFSETS) + 0.5) / OFFSETS, x.dtype)

    def one(v: Float[Array, " 3"]) -> Float[Array, ""]:
        offsets = jnp.quantile(jnp.sum(0.5 * (x + y) * v[None, :], axis=1), shares)
        values = jax.vmap(lambda omega: task.psi(jnp.append(v, omega)))(offsets)
        start = jnp.append(v, offsets[jnp.argmin(values)])
        return minimise(task.psi, start, manifold=SPHERE_LINE, max_steps=task.max_steps, tol=task.tol).value

    run = jax.jit(lambda normals: jnp.min(jax.vmap(one)(normals)))
    return lambda: run(task.starts[:, :3])


def with_optimistix(task: Task) -> Lowest:
    """Optimistix BFGS under one vmap."""
    import optimistix as optx

    solver: Any = optx.BFGS(rtol=task.tol, atol=task.tol)

    def one(start: Float[Array, " 4"]) -> Float[Array, ""]:
        solved: Any = optx.minimise(lambda z, _: task.free(z), solver, start, max_steps=task.max_steps, throw=False)
        return task.free(solved.value)

    run = jax.jit(lambda starts: jnp.nanmin(jax.vmap(one)(starts)))
    return lambda: run(task.starts)


def with_scipy(task: Task) -> Lowest:
    """SciPy's BFGS, start by start, on a compiled value and gradient."""
    compiled = jax.jit(jax.value_and_grad(task.free))

    def fun(z: Float[np.ndarray, " 4"]) -> tuple[float, Float[np.ndarray, " 4"]]:
        value, gradient = compiled(z)
        return float(value), np.asarray(gradient, float)

    options = {"gtol": task.tol, "maxiter": task.max_steps}

    def run() -> float:
        solved = (scipy.optimize.minimize(fun, z, jac=True, method="BFGS", options=options) for z in starts)
        return min(float(one.fun) for one in solved)

    starts = np.asarray(task.starts, float)
    return run


def with_pymanopt(task: Task, optimiser: str) -> Lowest:
    """Pymanopt on S² × R, start by start, on a compiled value and gradient."""
    import pymanopt
    from pymanopt.manifolds import Euclidean, Product, Sphere

    manifold = Product([Sphere(3), Euclidean(1)])
    compiled = jax.jit(jax.value_and_grad(task.psi))
    bent = jax.jit(lambda z, step: jax.jvp(jax.grad(task.psi), (z,), (step,))[1])

    @pymanopt.function.numpy(manifold)
    def cost(v: Float[np.ndarray, " 3"], omega: Float[np.ndarray, " 1"]) -> float:
        return float(compiled(np.append(v, omega))[0])

    @pymanopt.function.numpy(manifold)
    def gradient(v: Float[np.ndarray, " 3"], omega: Float[np.ndarray, " 1"]) -> list[Float[np.ndarray, " k"]]:
        slope = np.asarray(compiled(np.append(v, omega))[1], float)
        return [slope[:3], slope[3:]]

    @pymanopt.function.numpy(manifold)
    def hessian(*both: Float[np.ndarray, " k"]) -> list[Float[np.ndarray, " k"]]:
        turned = np.asarray(bent(np.concatenate(both[:2]), np.concatenate(both[2:])), float)
        return [turned[:3], turned[3:]]

    problem = pymanopt.Problem(manifold, cost, euclidean_gradient=gradient, euclidean_hessian=hessian)
    options = {"max_iterations": task.max_steps, "min_gradient_norm": task.tol, "verbosity": 0}
    starts = np.asarray(task.starts, float)

    def run() -> float:
        solver = getattr(pymanopt.optimizers, optimiser)(**options)
        return min(float(solver.run(problem, initial_point=[z[:3], z[3:]]).cost) for z in starts)

    return run


def available(task: Task) -> dict[str, Lowest]:
    """The solvers of the packages that are installed, by name."""
    found = {"optimistix BFGS, vmapped": with_optimistix(task), "SciPy BFGS, a loop": with_scipy(task)}
    if importlib.util.find_spec("pymanopt"):
        found |= {
            f"pymanopt {name}, a loop": with_pymanopt(task, name) for name in ("ConjugateGradient", "TrustRegions")
        }
    return found
