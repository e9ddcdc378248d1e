"""The unit sphere S², and S² × R, as manifolds to minimise on."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, PRNGKeyArray


def _dot(a: Float[Array, " d"], b: Float[Array, " d"]) -> Float[Array, ""]:
    """Inner product a · b, summed elementwise: `jnp.dot` in float32 runs in TF32 on a GPU."""
    return jnp.sum(a * b)


def normalise(u: Float[Array, " 3"]) -> Float[Array, " 3"]:
    """The unit vector u/‖u‖."""
    return u / jnp.sqrt(_dot(u, u))


def tangent_projection(v: Float[Array, " 3"], u: Float[Array, " 3"]) -> Float[Array, " 3"]:
    """P_v(u) = u − (u·v)v, the part of u in the tangent plane at v (paper, Sec. 3.2)."""
    return u - _dot(u, v) * v


def retract(v: Float[Array, " 3"], u: Float[Array, " 3"]) -> Float[Array, " 3"]:
    """The point (v + u)/‖v + u‖: a second-order retraction of the tangent vector u at v."""
    return normalise(v + u)


def transport(v: Float[Array, " 3"], w: Float[Array, " 3"]) -> Float[Array, "3 3"]:
    """The isometry T = I − (v+w)(v+w)ᵀ/(1+v·w) + 2wvᵀ: parallel transport from v to w (T v = w).

    Undefined at w = −v, which no retraction reaches.
    """
    s = v + w
    return jnp.eye(3, dtype=v.dtype) - jnp.outer(s, s) / (1 + _dot(v, w)) + 2 * jnp.outer(w, v)


def tangent_basis(v: Float[Array, " 3"]) -> Float[Array, "3 2"]:
    """Two orthonormal tangent vectors at v: columns 1 and 2 of the isometry that takes e₃ (or −e₃) to v."""
    pole = jnp.asarray([0.0, 0.0, 1.0], v.dtype) * jnp.where(v[2] < 0, -1, 1)
    return transport(pole, v)[:, :2]


def random_points(key: PRNGKeyArray, num: int) -> Float[Array, "num 3"]:
    """`num` independent directions, uniform on the sphere."""
    return jax.vmap(normalise)(jax.random.normal(key, (num, 3)))


class Manifold(NamedTuple):
    """What a solver needs of a manifold embedded in R^d.

    Attributes:
        project: (z, u) -> the tangent part of u at z.
        retract: (z, u) -> the point reached from z along the tangent vector u.
        transport: (z, w) -> a d × d isometry that takes tangent vectors at z to tangent vectors at w.
        basis: z -> d × k, an orthonormal basis of the tangent space at z.
    """

    project: Callable[[Array, Array], Array]
    retract: Callable[[Array, Array], Array]
    transport: Callable[[Array, Array], Array]
    basis: Callable[[Array], Array]


def _flat_project(z: Float[Array, " d"], u: Float[Array, " d"]) -> Float[Array, " d"]:
    return jnp.concatenate([tangent_projection(z[:3], u[:3]), u[3:]])


def _flat_retract(z: Float[Array, " d"], u: Float[Array, " d"]) -> Float[Array, " d"]:
    return jnp.concatenate([retract(z[:3], u[:3]), z[3:] + u[3:]])


def _flat_transport(z: Float[Array, " d"], w: Float[Array, " d"]) -> Float[Array, "d d"]:
    return jnp.eye(len(z), dtype=z.dtype).at[:3, :3].set(transport(z[:3], w[:3]))


def _flat_basis(z: Float[Array, " d"]) -> Float[Array, "d d-1"]:
    return jnp.eye(len(z), dtype=z.dtype)[:, 1:].at[:3, :2].set(tangent_basis(z[:3]))


SPHERE = Manifold(tangent_projection, retract, transport, tangent_basis)
"""S²: points are unit vectors v of shape (3,)."""

SPHERE_LINE = Manifold(_flat_project, _flat_retract, _flat_transport, _flat_basis)
"""S² × R: points are (v, ω), shape (4,); with more numbers after v, S² × R², and so on."""
