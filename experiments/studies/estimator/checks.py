"""The estimator's numeric checks: each measured value beside its target.

Gradients against autodiff, the Welsch loss, Riemannian BFGS on a quadratic, second opinions on the optimum, the
superlinear tail. What becomes of a fit under JAX's transformations is in `transformations`.
"""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import scipy.optimize
from jaxtyping import Array, Float

from experiments.data.descriptions import PLANTED
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.datasets.planted_pairs import PlantedPairs, planted_pairs
from symjax.l2e import objective
from symjax.l2e.manifolds import SPHERE, SPHERE_LINE, exponential, random_points, tangent_projection
from symjax.l2e.solvers.alternating import alternate
from symjax.l2e.solvers.rbfgs import minimize

"""JAX's own event of one compilation."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        problems: random problems over which a check takes its worst value.
        num_pairs: pairs of a planted cloud.
        sigma: scale σ of the residual in the fits.
        seed: seed of all problems.
    """

    problems: int = 20
    num_pairs: int = 100
    sigma: float = 0.05
    seed: int = 0


SIZES = {"full": Config(), "small": Config(problems=3, num_pairs=60)}


def run(config: Config) -> list[Row]:
    """One row a check; under float64."""
    checks = (gradients, taylor, welsch, quadratic, optima, tail)
    with jax.enable_x64(True):
        return [row for check in checks for row in check(config)]


def row(check: str, measured: float | Array, target: float, relation: str = "<=", note: str = "") -> Row:
    """A measured value, its target, and whether it is met."""
    measured = float(measured)
    passed = {"<=": measured <= target, "=": abs(measured - target) <= 0.05, ">=": measured >= target}[relation]
    return {
        "check": check,
        "measured": measured,
        "target": f"{relation} {target:g}",
        "passed": bool(passed),
        "note": note,
    }


def _problem(config: Config, k: int) -> tuple[Array, Array, float, Array, Array]:
    """A plane and pairs in no relation: (v, ω, σ, x, y)."""
    rng = np.random.default_rng([config.seed, k])
    v = rng.normal(size=3)
    x, y = 0.4 * rng.normal(size=(2, config.num_pairs, 3))
    return jnp.asarray(v / np.linalg.norm(v)), jnp.asarray(rng.normal() / 4), 0.4, jnp.asarray(x), jnp.asarray(y)


def planted(config: Config) -> PlantedPairs:
    """Pairs of which half are wrong."""
    return planted_pairs(np.random.default_rng(config.seed), config.num_pairs, 0.5, "thin", shift=0.0)


def gradients(config: Config) -> Iterator[Row]:
    """Projected autodiff gradients against the paper's closed forms."""
    errors = []
    for k in range(config.problems):
        problem = _problem(config, k)
        v = problem[0]
        auto_v, auto_omega = jax.grad(objective.l2e_objective, argnums=(0, 1))(*problem)
        grad_v, grad_omega = objective.l2e_gradients(*problem)
        auto, closed = tangent_projection(v, auto_v), tangent_projection(v, grad_v)
        size = jnp.sqrt(jnp.sum(closed**2) + grad_omega**2)
        errors.append((jnp.linalg.norm(auto - closed) / size, abs(auto_omega - grad_omega) / size))
    for name, error in zip(("projected gradient in v", "gradient in omega"), np.max(errors, axis=0), strict=True):
        yield row(f"{name}: autodiff against closed form, relative", error, 1e-13)


def taylor(config: Config) -> Iterator[Row]:
    """Slope of the first-order error on a log-log plot."""
    slopes = []
    steps = np.array([1e-3, 1e-4, 1e-5])
    for k in range(config.problems):
        v, omega, sigma, x, y = _problem(config, k)
        u = tangent_projection(v, jnp.asarray([1.0, -2.0, 0.5]))
        grad_v, grad_omega = objective.l2e_gradients(v, omega, sigma, x, y)
        value, slope = objective.l2e_objective(v, omega, sigma, x, y), grad_v @ u + 0.7 * grad_omega
        moved = [objective.l2e_objective(exponential(v, t * u), omega + 0.7 * t, sigma, x, y) for t in steps]
        error = np.abs(np.asarray(moved) - value - steps * slope)
        slopes.append(np.polyfit(np.log(steps), np.log(error), 1)[0])
    worst = slopes[int(np.argmax(np.abs(np.asarray(slopes) - 2)))]
    yield row("slope of the Taylor error", worst, 2, "=", f"farthest from 2 of {config.problems}; within 0.05")


def welsch(config: Config) -> Iterator[Row]:
    """The loss is affine in Barron's general loss at α = −∞ (CVPR 2019): 1 − exp(−(r/c)²/2)."""
    errors = []
    for k in range(config.problems):
        v, omega, sigma, x, y = _problem(config, k)
        image = x - 2 * (x @ v - omega)[:, None] * v[None, :]
        rho = 1 - jnp.exp(-0.5 * jnp.sum((y - image) ** 2, axis=1) / sigma**2)
        expected = (4 * np.pi * sigma**2) ** -1.5 - 2 * (2 * np.pi * sigma**2) ** -1.5 * (1 - jnp.mean(rho))
        errors.append(abs(objective.l2e_loss(v, omega, sigma, x, y) / expected - 1))
    yield row("L2E loss against Barron's Welsch loss, relative", max(errors), 1e-12)


def quadratic(config: Config) -> Iterator[Row]:
    """Riemannian BFGS on vᵀHv."""
    A = np.random.default_rng(config.seed).normal(size=(config.problems, 3, 3))
    H = jnp.asarray(A + A.swapaxes(1, 2))
    starts = random_points(jax.random.key(config.seed), config.problems)
    smallest = np.linalg.eigh(H)[1][:, :, 0]
    solve = jax.jit(jax.vmap(lambda H, v: _quadratic(H, v).point))
    sine = np.linalg.norm(np.cross(solve(H, starts), smallest), axis=1)
    yield row("RBFGS on v'Hv: sine to the smallest eigenvector", sine.max(), 1e-10)


def _quadratic(H: Float[Array, "3 3"], v: Float[Array, "3"], **options: Any) -> Any:
    return minimize(lambda v: v @ H @ v, v, manifold=SPHERE, tol=1e-11, **options)


def optima(config: Config) -> Iterator[Row]:
    """The optimum of the joint solver against three other opinions."""
    p = planted(config)
    x, y = jnp.asarray(p.x), jnp.asarray(p.y)
    v = p.normal + 0.1 * np.random.default_rng(config.seed + 1).normal(size=3)
    z0 = jnp.append(v / np.linalg.norm(v), p.offset + 0.03)

    def fun(z: Float[Array, "4"]) -> Float[Array, ""]:
        return objective.scaled_log_loss(z[:3], z[3], jnp.asarray(config.sigma), x, y)

    joint = minimize(fun, z0, manifold=SPHERE_LINE, tol=1e-11).point
    others: dict[str, tuple[Callable[[], Any], float]] = {
        "the paper's alternation": (lambda: alternate(fun, z0, tol=1e-8).point, 1e-6),
        "scipy's BFGS in a chart": (lambda: _by_scipy(fun, z0), 1e-6),
        "jaxopt's projected gradient": (lambda: _by_jaxopt(fun, z0), 1e-6),
    }
    for name, (solve, target) in others.items():
        try:
            other = solve()
        except ImportError:
            yield {**row(f"optimum of joint RBFGS and {name}", np.nan, target), "note": "jaxopt is not installed"}
            continue
        yield row(f"optimum of joint RBFGS and {name}: largest difference", jnp.abs(other - joint).max(), target)


def _by_scipy(fun: Callable[[Array], Array], z0: Float[Array, "4"]) -> Float[Array, "4"]:
    basis = SPHERE_LINE.basis(z0)
    chart = jax.jit(jax.value_and_grad(lambda t: fun(SPHERE_LINE.retract(z0, basis @ t))))
    solved = scipy.optimize.minimize(
        lambda t: [np.asarray(a, float) for a in chart(t)], np.zeros(3), jac=True, method="BFGS", options={"gtol": 1e-9}
    )
    return SPHERE_LINE.retract(z0, basis @ solved.x)


def _by_jaxopt(fun: Callable[[Array], Array], z0: Float[Array, "4"]) -> Float[Array, "4"]:
    with warnings.catch_warnings():
        # it warns that it is no longer maintained, and of JAX's deprecations
        warnings.simplefilter("ignore", DeprecationWarning)
        import jaxopt

        def onto_the_sphere(z: Float[Array, "4"], _: None) -> Float[Array, "4"]:
            return jnp.append(jaxopt.projection.projection_l2_sphere(z[:3]), z[3])

        return jaxopt.ProjectedGradient(fun, onto_the_sphere, maxiter=2000, tol=1e-9).run(z0, None).params


def tail(config: Config) -> Iterator[Row]:
    """Ratios of successive gradient norms near the optimum: they fall to zero where convergence is superlinear."""
    A = np.random.default_rng(config.seed).normal(size=(3, 3))
    H, start = jnp.asarray(A + A.T), random_points(jax.random.key(config.seed), 1)[0]
    solve = jax.jit(lambda k: minimize(lambda v: v @ H @ v, start, manifold=SPHERE, max_steps=k, tol=1e-13).grad_norm)
    norms = np.array([solve(k) for k in range(1, 25)])
    near = norms[(norms < 1e-1) & (norms > 1e-13)]
    near = near[np.append(True, np.diff(near) != 0)]
    ratios = near[1:] / near[:-1]
    note = "ratios " + " ".join(f"{ratio:.1e}" for ratio in ratios)
    yield row("superlinear tail: last ratio of gradient norms", ratios[-1], 0.01, note=note)


def summary(rows: list[Row]) -> list[Row]:
    """The checks themselves."""
    return rows


STUDY = Study("checks", __doc__, SIZES, run, summary, data=PLANTED)
