"""The estimator's numbers: each is computed here by two independent ways, and their difference printed.

Gradients against the paper's closed form, the loss against Barron's, the solvers against each other, against SciPy and
jaxopt, the implicit derivative against central differences, and the number of compilations of a sweep.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
import scipy.optimize
from jaxtyping import Array, Float

import symjax
from experiments import report
from experiments.report import Row
from symjax import fit, objective, sphere
from symjax.bfgs import minimize
from symjax.planted import PlantedPairs, planted_pairs
from symjax.sphere import SPHERE, SPHERE_LINE


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_pairs: planted pairs.
        outliers: share of outlier pairs.
        sigma: scale σ of the residual.
        trials: random planes, or problems, of every check; the worst is printed.
        seed: of everything.
    """

    num_pairs: int = 500
    outliers: float = 0.5
    sigma: float = 0.05
    trials: int = 50
    seed: int = 0


SIZES = {"full": Config(), "small": Config(num_pairs=100, trials=3)}


def run(config: Config) -> list[Row]:
    """One row a check."""
    with jax.enable_x64(True):
        return [
            *_gradients(config),
            _taylor(config),
            _welsch(config),
            _eigenvector(config),
            *_same_optimum(config),
            _tail(config),
            _implicit(config),
            _compilations(config),
        ]


def _row(check: str, value: float, target: str) -> Row:
    return {"check": check, "value": float(value), "target": target}


def _truth(config: Config, trial: int) -> PlantedPairs:
    return planted_pairs(np.random.default_rng([config.seed, trial]), config.num_pairs, config.outliers, "isotropic")


def _pairs(config: Config, trial: int) -> tuple[Array, Array]:
    truth = _truth(config, trial)
    return jnp.asarray(truth.x), jnp.asarray(truth.y)


def _relative(a: Float[Array, "..."], b: Float[Array, "..."]) -> float:
    return float(jnp.linalg.norm(a - b) / jnp.linalg.norm(b))


def _gradients(config: Config) -> list[Row]:
    projected, along = [], []
    # σ is the blob's size here: at random planes a small one leaves no weight to differentiate
    sigma = 1.0
    for trial in range(config.trials):
        x, y = _pairs(config, trial)
        v = sphere.random_points(jax.random.key(trial), 1)[0]
        automatic = jax.grad(objective.l2e_objective, (0, 1))(v, 0.1, sigma, x, y)
        printed = objective.l2e_gradients(v, jnp.asarray(0.1), jnp.asarray(sigma), x, y)
        projected.append(
            _relative(sphere.tangent_projection(v, automatic[0]), sphere.tangent_projection(v, printed[0]))
        )
        along.append(_relative(automatic[1], printed[1]))
    return [
        _row("projected gradient, autodiff against closed form, relative", max(projected), "<= 1e-13"),
        _row("derivative in omega, autodiff against closed form, relative", max(along), "<= 1e-13"),
    ]


def _taylor(config: Config) -> Row:
    """Slope of log error against log step of the first-order expansion along a geodesic."""
    x, y = _pairs(config, 0)
    v = sphere.random_points(jax.random.key(0), 1)[0]
    u = sphere.tangent_projection(v, jnp.array([0.3, -0.5, 0.7]))
    u = u / jnp.linalg.norm(u)

    def along(t: Float[Array, ""]) -> Float[Array, ""]:
        return objective.log_objective(sphere.exponential(v, t * u), 0.1, 1.0, x, y)

    steps = np.geomspace(1e-4, 1e-2, 9)
    slope = jax.grad(along)(0.0)
    errors = [abs(along(t) - along(0.0) - t * slope) for t in steps]
    return _row("slope of the Taylor error", np.polyfit(np.log(steps), np.log(errors), 1)[0], "2")


def _welsch(config: Config) -> Row:
    """Barron's general loss at alpha = -inf is 1 - exp(-(r/c)²/2): the L2E loss up to a constant and a factor."""
    x, y = _pairs(config, 0)
    worst = 0.0
    for trial in range(config.trials):
        v = sphere.random_points(jax.random.key(trial), 1)[0]
        welsch = 1 - jnp.exp(-0.5 * objective.squared_residuals(v, 0.1, x, y) / config.sigma**2)
        height = (2 * np.pi * config.sigma**2) ** -1.5
        expected = (4 * np.pi * config.sigma**2) ** -1.5 - 2 * height * (1 - jnp.mean(welsch))
        worst = max(worst, abs(float(symjax.l2e_loss(v, 0.1, config.sigma, x, y) / expected - 1)))
    return _row("L2E loss against Barron's Welsch loss, relative", worst, "rounding")


def _eigenvector(config: Config) -> Row:
    worst = 0.0
    for trial in range(config.trials):
        rng = np.random.default_rng([config.seed, trial])
        A = rng.normal(size=(3, 3))
        H = jnp.asarray(A + A.T)
        start = sphere.random_points(jax.random.key(trial), 1)[0]
        found = minimize(lambda v, H=H: v @ H @ v, start, manifold=SPHERE, tol=1e-12).point
        smallest = jnp.linalg.eigh(H)[1][:, 0]
        worst = max(worst, float(jnp.linalg.norm(jnp.cross(found, smallest))))
    return _row("Riemannian BFGS on v'Hv against the smallest eigenvector, radians", worst, "<= 1e-10")


def _same_optimum(config: Config) -> list[Row]:
    x, y = _pairs(config, 0)
    truth = _truth(config, 0)
    v0 = jnp.asarray(truth.normal) + jnp.array([0.05, -0.08, 0.04])
    v0 = v0 / jnp.linalg.norm(v0)
    joint = symjax.fit_plane(x, y, config.sigma, v0)

    def loss(z: Float[Array, "4"]) -> Float[Array, ""]:
        v = z[:3] / jnp.linalg.norm(z[:3])
        return objective.scaled_log_loss(v, z[3], config.sigma, x, y)

    z0 = jnp.append(v0, truth.offset)
    options = {"gtol": 1e-12}
    outer = scipy.optimize.minimize(jax.jit(loss), z0, jac=jax.jit(jax.grad(loss)), method="BFGS", options=options).x
    others = {
        "the alternation of Algorithm 1": symjax.fit_plane(x, y, config.sigma, v0, solver="alternating").plane.normal,
        "Riemannian BFGS with strong Wolfe steps": symjax.fit_plane(
            x, y, config.sigma, v0, line_search="wolfe"
        ).plane.normal,
        "SciPy's BFGS": jnp.asarray(outer[:3]),
    }
    projected = _jaxopt(loss, z0)
    if projected is None:
        print("jaxopt is not installed: its check is left out (pip install '.[test]')")
    else:
        others["jaxopt's projected gradient"] = projected[:3]
    return [
        _row(
            f"joint solver against {name}, degrees", float(joint.plane.angle(symjax.Plane(v, jnp.zeros(())))), "<= 1e-5"
        )
        for name, v in others.items()
    ]


def _jaxopt(loss, z0: Float[Array, "4"]) -> Float[Array, "4"] | None:  # type: ignore[no-untyped-def]
    with warnings.catch_warnings():
        # it is no longer maintained, and says so
        warnings.simplefilter("ignore")
        try:
            import jaxopt
        except ImportError:
            return None
        projection = lambda z, _: z.at[:3].set(z[:3] / jnp.linalg.norm(z[:3]))  # noqa: E731
        return jaxopt.ProjectedGradient(loss, projection, maxiter=2000, tol=1e-12).run(z0).params


def _tail(config: Config) -> Row:
    """Ratio of the last two gradient norms above rounding: zero in the limit for a superlinear method."""
    x, y = _pairs(config, 0)
    truth = _truth(config, 0)
    z0 = jnp.append(sphere.normalise(jnp.asarray(truth.normal) + 0.05), truth.offset)

    def fun(z: Float[Array, "4"]) -> Float[Array, ""]:
        return objective.scaled_log_loss(z[:3], z[3], config.sigma, x, y)

    solve = jax.jit(lambda steps: minimize(fun, z0, manifold=SPHERE_LINE, max_steps=steps, tol=1e-15).grad_norm)
    norms = np.array([float(solve(k)) for k in range(40)])
    above = norms[norms > 1e-13]
    return _row("last ratio of gradient norms above 1e-13", above[-1] / above[-2], "<= 0.1")


def _implicit(config: Config) -> Row:
    worst, step = 0.0, 1e-6
    for trial in range(min(config.trials, 10)):
        x, y = _pairs(config, trial)
        truth = planted_pairs(
            np.random.default_rng([config.seed, trial]), config.num_pairs, config.outliers, "isotropic"
        )
        v0 = jnp.asarray(truth.normal)
        rng = np.random.default_rng([config.seed, trial, 1])
        dx, dsigma = jnp.asarray(rng.normal(size=x.shape)), 0.3

        def answer(x: Array, sigma: Array, y: Array = y, v0: Array = v0) -> Array:
            plane = symjax.fit_plane(x, y, sigma, v0, tol=1e-14).plane
            return jnp.append(plane.normal, plane.offset)

        _, tangent = jax.jvp(answer, (x, jnp.asarray(config.sigma)), (dx, jnp.asarray(dsigma)))
        above, below = (answer(x + s * dx, jnp.asarray(config.sigma + s * dsigma)) for s in (step, -step))
        worst = max(worst, _relative(tangent, (above - below) / (2 * step)))
    return _row("implicit derivative against central differences, relative", worst, "<= 1e-6")


def _compilations(config: Config) -> Row:
    x, y = _pairs(config, 0)
    before = fit._sweep._cache_size()
    for sigmas in ([0.03, 0.05, 0.1], [0.04, 0.06, 0.2]):
        symjax.sweep(x, y, np.array(sigmas), sphere.fibonacci(19))
    return _row("compilations of two sweeps of 3 sigmas and 19 starts", fit._sweep._cache_size() - before, "1")


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    report.main(__file__, __doc__, SIZES, run, lambda rows: rows, argv=argv)


if __name__ == "__main__":
    main()
