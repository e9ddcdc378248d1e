"""Algorithm 1 of the paper: ω and v in turn."""

from collections.abc import Callable
from typing import Any, cast

import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int

from symjax.bfgs import Minimum, ending, minimize
from symjax.sphere import SPHERE, SPHERE_LINE

INNER_STEPS = 64  # limit on the steps of one inner solve


@jax.default_matmul_precision("highest")
def alternate(
    fun: Callable[[Float[Array, "4"]], Float[Array, ""]],
    z0: Float[Array, "4"],
    *,
    line_search: str = "armijo",
    max_steps: int | Int[Array, ""] = 200,
    tol: float | Float[Array, ""] = 1e-10,
) -> Minimum:
    """Minimises over ω by BFGS given v, then over v by Riemannian BFGS given ω, until both gradients vanish.

    Algorithm 1 of the paper. It converges linearly, and many times more slowly than `bfgs.minimize` of both
    at once.

    Args:
        fun: function of z = (v, ω) on S² × R.
        z0: start.
        line_search: of the Riemannian solve: "armijo" or "wolfe".
        max_steps: limit on the rounds.
        tol: bound on the norm of the joint Riemannian gradient.

    Returns:
        The minimum; `num_steps` counts rounds.
    """
    value_and_grad = jax.value_and_grad(fun)
    # annotated loosely: optimistix types atol as a float, and takes a traced one
    omega_solver: Any = optx.BFGS(rtol=0.0, atol=cast(float, 0.5 * tol))

    def joint(z: Float[Array, "4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        value, grad = value_and_grad(z)
        return value, jnp.linalg.norm(SPHERE_LINE.project(z, grad))

    State = tuple[Array, Array, Array, Int[Array, ""], Bool[Array, ""]]

    def going(state: State) -> Bool[Array, ""]:
        _, value, grad_norm, k, stalled = state
        return jnp.isfinite(value) & (grad_norm > tol) & (k < max_steps) & ~stalled

    def round_(state: State) -> State:
        z, _, _, k, _ = state
        v = z[:3]
        # throw=False: under vmap one lane that runs out of steps must not fail the others
        solve: Any = optx.minimise(
            lambda omega, _: fun(jnp.append(v, omega)),
            omega_solver,
            z[3],
            max_steps=INNER_STEPS,
            throw=False,
        )
        omega = solve.value
        inner = minimize(
            lambda v: fun(jnp.append(v, omega)),
            v,
            manifold=SPHERE,
            line_search=line_search,
            max_steps=INNER_STEPS,
            tol=0.5 * tol,
        )
        new = jnp.append(inner.point, omega)
        new_value, grad_norm = joint(new)
        return new, new_value, grad_norm, k + 1, jnp.all(new == z)

    z, value, grad_norm, k, stalled = jax.lax.while_loop(
        going, round_, (z0, *joint(z0), jnp.asarray(0), jnp.asarray(False))
    )
    return Minimum(z, value, grad_norm, k, ending(grad_norm, tol, value, stalled))
