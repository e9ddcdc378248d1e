"""Derivatives of a minimiser on a manifold, by the implicit function theorem."""

from collections.abc import Callable
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PyTree

from symjax.l2e.jax_config import full_precision
from symjax.l2e.manifolds import Manifold

Objective = Callable[[Float[Array, " d"], PyTree], Float[Array, ""]]


@partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def implicit_minimum(
    fun: Objective, manifold: Manifold, z: Float[Array, " d"], value: Float[Array, ""], theta: PyTree
) -> tuple[Float[Array, " d"], Float[Array, ""]]:
    """Returns z and its value, and gives them the derivatives in theta of a minimiser of `fun(·, theta)`.

    At a minimum the gradient G in the tangent chart t ↦ R_z(B t) is zero for every theta. Therefore
    dt = −H⁻¹ ∂_θG dθ and dz = B dt: one small solve with the Hessian H of the chart. The value changes as if z were
    constant (the envelope theorem). The rule is a linear jvp, so JAX transposes it for reverse mode. It calls itself,
    so it can be differentiated again.

    Args:
        fun: the function that z minimises, called as `fun(z, theta)`.
        manifold: the manifold of z.
        z: a minimiser. Its own derivative is discarded, because the minimiser does not depend on the start.
        value: `fun(z, theta)`, known from the solver. Its own derivative is discarded.
        theta: parameters of the function.

    Returns:
        z and value.
    """
    del fun, manifold, theta
    return z, value


@implicit_minimum.defjvp
@full_precision
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
