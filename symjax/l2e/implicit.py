"""Derivatives of a minimiser on a manifold, by the implicit function theorem."""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PyTree

from symjax.l2e.manifolds import Manifold

Objective = Callable[[Float[Array, " d"], PyTree], Float[Array, ""]]


@partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def implicit_minimum(
    fun: Objective, manifold: Manifold, z: Float[Array, " d"], value: Float[Array, ""], theta: PyTree
) -> tuple[Float[Array, " d"], Float[Array, ""]]:
    """Returns z and its value, with the derivatives in theta that a minimiser of `fun(·, theta)` has.

    At a minimum the gradient G in the tangent chart t ↦ R_z(B t) is zero whatever theta is, so
    dt = −H⁻¹ ∂_θG dθ and dz = B dt: one small solve with the chart's Hessian H. The value changes as if z stood
    still (the envelope theorem). Because the rule is a linear jvp it is transposed for reverse mode, and because it
    calls itself it can be differentiated again.

    Args:
        fun: the function that z minimises; `fun(z, theta)`.
        manifold: the manifold it is minimised on.
        z: a minimiser; its own derivative is discarded (an answer does not depend on its start).
        value: `fun(z, theta)`, which the solver knows; its own derivative is discarded.
        theta: parameters of the function.

    Returns:
        z and value.
    """
    del fun, manifold, theta
    return z, value


@implicit_minimum.defjvp
@jax.default_matmul_precision("highest")
def _implicit_minimum_jvp(
    fun: Objective, manifold: Manifold, primals: tuple[Any, Any, Any], tangents: tuple[Any, Any, Any]
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    (z, value, theta), (_, _, theta_dot) = primals, tangents
    z, value = implicit_minimum(fun, manifold, z, value, theta)
    basis = manifold.basis(z)

    def chart(t: Float[Array, " k"], theta: PyTree) -> Float[Array, ""]:
        return fun(manifold.retract(z, basis @ t), theta)

    origin = jnp.zeros(basis.shape[1], z.dtype)
    hessian = jax.hessian(chart)(origin, theta)
    (_, gradient), (value_dot, gradient_dot) = jax.jvp(
        lambda theta: jax.value_and_grad(chart)(origin, theta), (theta,), (theta_dot,)
    )
    del gradient
    return (z, value), (-basis @ jnp.linalg.solve(hessian, gradient_dot), value_dot)
