"""The manifolds that the solvers minimise on: the unit sphere S² and the product S² × R."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray


def _dot(a: Float[Array, " d"], b: Float[Array, " d"]) -> Float[Array, ""]:
    """Returns a · b, summed elementwise because `jnp.dot` of float32 runs in TF32 on a GPU."""
    return jnp.sum(a * b)


def normalise(u: Float[Array, " 3"]) -> Float[Array, " 3"]:
    """Returns the unit vector u/‖u‖."""
    return u / jnp.sqrt(_dot(u, u))


def tangent_projection(v: Float[Array, " 3"], u: Float[Array, " 3"]) -> Float[Array, " 3"]:
    """Projects u onto the tangent plane at v: P_v(u) = u − (u·v)v (paper, Sec. 3.2)."""
    return u - _dot(u, v) * v


def retract(v: Float[Array, " 3"], u: Float[Array, " 3"]) -> Float[Array, " 3"]:
    """Moves from v along the tangent vector u to (v + u)/‖v + u‖, a second-order retraction."""
    return normalise(v + u)


def transport(v: Float[Array, " 3"], w: Float[Array, " 3"]) -> Float[Array, "3 3"]:
    """Returns the parallel transport from v to w, the isometry T = I − (v+w)(v+w)ᵀ/(1+v·w) + 2wvᵀ with T v = w.

    It is undefined at w = −v, which no retraction reaches.
    """
    s = v + w
    return jnp.eye(3, dtype=v.dtype) - jnp.outer(s, s) / (1 + _dot(v, w)) + 2 * jnp.outer(w, v)


def tangent_basis(v: Float[Array, " 3"]) -> Float[Array, "3 2"]:
    """Returns two orthonormal tangent vectors at v: columns 1 and 2 of the isometry that maps e₃ (or −e₃) to v."""
    pole = jnp.asarray([0.0, 0.0, 1.0], v.dtype) * jnp.where(v[2] < 0, -1, 1)
    return transport(pole, v)[:, :2]


def random_points(key: PRNGKeyArray, num: int) -> Float[Array, "num 3"]:
    """Draws `num` independent points, uniformly on the sphere."""
    return jax.vmap(normalise)(jax.random.normal(key, (num, 3)))


class Manifold(NamedTuple):
    """The operations of a manifold embedded in R^d that a solver needs.

    Attributes:
        project: (z, u) -> the tangent component of u at z.
        retract: (z, u) -> the point reached from z along the tangent vector u.
        transport: (z, w) -> a d × d isometry that maps tangent vectors at z to tangent vectors at w.
        basis: z -> d × k, an orthonormal basis of the tangent space at z.
    """

    project: Callable[[Array, Array], Array]
    retract: Callable[[Array, Array], Array]
    transport: Callable[[Array, Array], Array]
    basis: Callable[[Array], Array]


def _product_project(z: Float[Array, " d"], u: Float[Array, " d"]) -> Float[Array, " d"]:
    return jnp.concatenate([tangent_projection(z[:3], u[:3]), u[3:]])


def _product_retract(z: Float[Array, " d"], u: Float[Array, " d"]) -> Float[Array, " d"]:
    return jnp.concatenate([retract(z[:3], u[:3]), z[3:] + u[3:]])


def _product_transport(z: Float[Array, " d"], w: Float[Array, " d"]) -> Float[Array, "d d"]:
    return jnp.eye(len(z), dtype=z.dtype).at[:3, :3].set(transport(z[:3], w[:3]))


def _product_basis(z: Float[Array, " d"]) -> Float[Array, "d d-1"]:
    return jnp.eye(len(z), dtype=z.dtype)[:, 1:].at[:3, :2].set(tangent_basis(z[:3]))


SPHERE = Manifold(tangent_projection, retract, transport, tangent_basis)
"""S²: points are unit vectors v of shape (3,)."""

SPHERE_LINE = Manifold(_product_project, _product_retract, _product_transport, _product_basis)
"""S² × R: points are (v, ω) of shape (4,). With k coordinates after v it is S² × R^k."""
