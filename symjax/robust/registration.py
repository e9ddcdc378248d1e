"""L2E with refreshed correspondences: planes move until the mirrored cloud lies on the cloud.

The partner of a point is the surface point nearest to its mirror image, looked up in a voxel grid. The residual is the
mirror image's distance from the partner's tangent plane (and a share of its distance from the partner). Every step is a
Gauss-Newton step of the squares reweighted by the L2E weight exp(−‖r‖²/2σ²), which is the minorise-maximise step of the
L2E criterion, and σ goes down. Everything is in single precision, over a batch of planes, in fixed shapes.
"""

from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.manifolds import tangent_basis
from symjax.robust.voxel_grid import SIZE, VoxelGrid

BATCH_SIZE = 64
"""Planes computed at a time."""

FAR = 1.0
"""A point counts in full when its mirror image is several σ away from it: one on the plane agrees with any plane."""

DAMPING = 1e-3
"""Of the Gauss-Newton step, relative to the matrix: a flat direction is left alone."""

LONGEST_TURN, LONGEST_SHIFT = 0.2, 0.1
"""Limits of one step, in radians and in the unit of the points (the diagonal)."""


class Probes(NamedTuple):
    """Points that are mirrored.

    Attributes:
        x: the points.
        normals: their normals.
        weight: how much each counts.
    """

    x: Float[Array, "m 3"]
    normals: Float[Array, "m 3"]
    weight: Float[Array, " m"]


def _dot(a: Float[Array, "*#n 3"], b: Float[Array, "*#n 3"]) -> Float[Array, "*#n"]:
    """Products of rows, component by component.

    A sum over an axis of length 3 inside vmap is compiled wrongly by jaxlib 0.10 on some CPUs (the batch's last rows
    differ from the same rows alone), and a matrix product would run in TF32 on a GPU.
    """
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


class _Mirrored(NamedTuple):
    height: Float[Array, " m"]  # v·x − ω
    offset: Float[Array, "m 3"]  # from the partner to the mirror image
    normal: Float[Array, "m 3"]  # the partner's
    cosine: Float[Array, " m"]  # of the two normals; 1 if they are not used
    penalty: Float[Array, " m"]


def _mirrored(plane: Plane, probes: Probes, grid: VoxelGrid, use_normals: bool) -> _Mirrored:
    v, omega = map(jnp.asarray, plane)
    height = _dot(probes.x, v[None, :]) - omega
    image = probes.x - 2 * height[:, None] * v[None, :]
    at = jnp.clip(((image - grid.origin[None, :]) / grid.cell).astype(jnp.int32), 0, SIZE - 1)
    index: Int[Array, " m"] = (at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]
    normal = grid.normal[index]
    cosine = jnp.ones_like(height)
    if use_normals:
        cosine = jnp.abs(_dot(probes.normals, normal) - 2 * _dot(probes.normals, v[None, :]) * _dot(normal, v[None, :]))
    return _Mirrored(height, image - grid.point[index], normal, cosine, grid.penalty[index])


def _weight_and_agreement(
    sigma: Float[Array, ""], probes: Probes, m: _Mirrored
) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """How much each point counts, and how well its mirror image agrees with the partner, 0 to 1."""
    weight = probes.weight * (1 - jnp.exp(-2 * (m.height / (FAR * sigma)) ** 2))
    return weight, jnp.exp(-_dot(m.offset, m.offset) / (2 * sigma**2)) * m.cosine**2


@partial(jax.jit, static_argnames=("use_normals",))
def grid_scores(
    planes: Plane, sigma: Float[Array, ""], probes: Probes, grid: VoxelGrid, *, use_normals: bool = True
) -> Float[Array, " p"]:
    """Scores of planes, with the partners of the voxel grid (see `PlaneScore.score`).

    Args:
        planes: the planes.
        sigma: distance from the partner that still agrees.
        probes: points that are mirrored.
        grid: around the surface.
        use_normals: whether the normals must agree too.
    """

    def one(plane: Plane) -> Float[Array, ""]:
        m = _mirrored(plane, probes, grid, use_normals)
        weight, agreement = _weight_and_agreement(sigma, probes, m)
        agreeing = jnp.sum(weight * agreement)
        penalty = jnp.sum(weight * (1 - agreement) * m.penalty)
        return agreeing / (agreeing + penalty + 1e-6 * jnp.sum(probes.weight) + 1e-30)

    return jax.lax.map(one, planes, batch_size=BATCH_SIZE)


@partial(jax.jit, static_argnames=("isotropic", "use_normals"))
def register(
    planes: Plane,
    sigmas: Float[Array, " s"],
    probes: Probes,
    grid: VoxelGrid,
    *,
    isotropic: float,
    use_normals: bool = True,
) -> Plane:
    """Moves every plane, one step for every σ.

    Args:
        planes: where to start.
        sigmas: σ of every step, in the unit of the points.
        probes: points whose mirror images are fitted.
        grid: around the surface.
        isotropic: share of the plain distance in the residual: it holds a plane that slides along a surface.
        use_normals: whether the weight falls where the normals do not agree.
    """

    def one(plane: Plane) -> Plane:
        def step(plane: Plane, sigma: Float[Array, ""]) -> tuple[Plane, None]:
            m = _mirrored(plane, probes, grid, use_normals)
            return _step(plane, sigma, probes, m, isotropic), None

        return jax.lax.scan(step, plane, sigmas)[0]

    return jax.lax.map(one, planes, batch_size=BATCH_SIZE)


def _step(plane: Plane, sigma: Float[Array, ""], probes: Probes, m: _Mirrored, isotropic: float) -> Plane:
    v, omega = map(jnp.asarray, plane)
    weight, agreement = _weight_and_agreement(sigma, probes, m)
    weight = weight * agreement
    along = _dot(m.normal, v[None, :])
    residual = _dot(m.normal, m.offset)
    # derivative of the residual n·(x − 2(v·x − ω)v − y) in v (a vector a row) and in ω
    slope = -2 * (along[:, None] * probes.x + m.height[:, None] * m.normal)
    basis = tangent_basis(v)
    jacobian = [_dot(slope, basis[None, :, 0]), _dot(slope, basis[None, :, 1]), 2 * along]
    # of the plain distance: the image moves by −2(δ·x − δω)v − 2(v·x − ω)δ
    swing = [_dot(probes.x, basis[None, :, 0]), _dot(probes.x, basis[None, :, 1]), -jnp.ones_like(m.height)]
    across, off = _dot(m.offset, v[None, :]), [_dot(m.offset, basis[None, :, k]) for k in range(2)]
    lever = [m.height * off[0], m.height * off[1], jnp.zeros_like(m.height)]

    def entry(i: int, j: int) -> Float[Array, ""]:
        square = swing[i] * swing[j] + (m.height**2 if i == j < 2 else 0)
        return jnp.sum(weight * (jacobian[i] * jacobian[j] + 4 * isotropic * square))

    def slope_entry(i: int) -> Float[Array, ""]:
        return jnp.sum(weight * (jacobian[i] * residual - 2 * isotropic * (swing[i] * across + lever[i])))

    turn_1, turn_2, shift = _solve(
        [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)],
        [slope_entry(0), slope_entry(1), slope_entry(2)],
    )
    turn = jnp.sqrt(turn_1**2 + turn_2**2)
    scale = jnp.minimum(1, LONGEST_TURN / jnp.maximum(turn, 1e-12))
    moved = v - scale * (turn_1 * basis[:, 0] + turn_2 * basis[:, 1])
    moved = moved / jnp.sqrt(_dot(moved, moved))
    return Plane(moved, omega - jnp.clip(shift, -LONGEST_SHIFT, LONGEST_SHIFT))


def _solve(matrix: list[Array], vector: list[Array]) -> tuple[Array, Array, Array]:
    """The solution of a damped symmetric 3 × 3 system by Cramer's rule, its upper triangle given row by row."""
    a, b, c, d, e, f = matrix
    damping = DAMPING * (a + d + f) / 3 + 1e-12
    a, d, f = a + damping, d + damping, f + damping
    m_aa, m_ab, m_ac = d * f - e * e, c * e - b * f, b * e - c * d
    m_bb, m_bc, m_cc = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * m_aa + b * m_ab + c * m_ac
    inverse = jnp.where(jnp.abs(determinant) > 0, 1 / jnp.where(determinant == 0, 1, determinant), 0)
    x, y, z = vector
    return (
        inverse * (m_aa * x + m_ab * y + m_ac * z),
        inverse * (m_ab * x + m_bb * y + m_bc * z),
        inverse * (m_ac * x + m_bc * y + m_cc * z),
    )
