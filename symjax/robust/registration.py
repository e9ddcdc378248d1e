"""Registration: moves planes until the reflected cloud lies on the cloud, with partners from the voxel grid.

The partner of a point is the surface point nearest to its mirror image, as in ICP. The residual r is the distance of
the mirror image from the partner's tangent plane, with a fraction of its distance from the partner itself. Every step
is a Gauss-Newton step on the squares weighted by exp(−‖r‖²/2σ²): the majorise-minimise step of the L2E criterion. The
partners are looked up anew before every step, and σ decreases.

Everything runs in single precision over a batch of planes, in arrays of fixed shapes.
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
"""Planes that are computed at a time."""

DISPLACEMENT_SCALE = 1.0
"""Distance between a point and its mirror image, in units of σ, at which the weight of the point reaches 1 − exp(−½). A
point on the plane is its own mirror image and agrees with every plane through it."""

DAMPING = 1e-3
"""Damping of the Gauss-Newton step, relative to the mean diagonal entry of its matrix. The plane does not move in a
direction that the cloud does not determine."""

MAX_TURN, MAX_SHIFT = 0.2, 0.1
"""Limits of one step: of the normal in radians, and of the offset in diagonals."""


class Probes(NamedTuple):
    """The points that are reflected.

    Attributes:
        x: the points.
        normals: their surface normals.
        weight: their weights.
    """

    x: Float[Array, "m 3"]
    normals: Float[Array, "m 3"]
    weight: Float[Array, " m"]


class _Match(NamedTuple):
    """Mirror images of the probes, compared with their partners."""

    height: Float[Array, " m"]  # of the point above the plane: v·x − ω
    offset: Float[Array, "m 3"]  # of the mirror image from the partner
    normal: Float[Array, "m 3"]  # of the partner
    cosine: Float[Array, " m"]  # between the reflected normal and the partner's; 1 if normals are not used
    penalty: Float[Array, " m"]  # non-match penalty


def _dot(a: Float[Array, "*#n 3"], b: Float[Array, "*#n 3"]) -> Float[Array, "*#n"]:
    """Returns the scalar product of each pair of rows, component by component.

    A sum over an axis of length 3 inside vmap is compiled wrongly by jaxlib 0.10 on some CPUs (the last rows of the
    batch differ from the same rows alone), and a matrix product would run in TF32 on a GPU.
    """
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _match(plane: Plane, probes: Probes, grid: VoxelGrid, use_normals: bool) -> _Match:
    """Reflects the probes and looks up their partners."""
    v, omega = map(jnp.asarray, plane)
    height = _dot(probes.x, v[None, :]) - omega
    image = probes.x - 2 * height[:, None] * v[None, :]
    voxel = jnp.clip(((image - grid.origin[None, :]) / grid.cell).astype(jnp.int32), 0, SIZE - 1)
    index: Int[Array, " m"] = (voxel[:, 0] * SIZE + voxel[:, 1]) * SIZE + voxel[:, 2]
    normal = jnp.asarray(grid.normal)[index]
    cosine = jnp.ones_like(height)
    if use_normals:
        cosine = jnp.abs(_dot(probes.normals, normal) - 2 * _dot(probes.normals, v[None, :]) * _dot(normal, v[None, :]))
    return _Match(height, image - grid.point[index], normal, cosine, jnp.asarray(grid.penalty)[index])


def _weight_and_agreement(
    sigma: Float[Array, ""], probes: Probes, match: _Match
) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """Returns the weight of each probe, and the agreement of its mirror image with the partner, 0 to 1."""
    weight = probes.weight * (1 - jnp.exp(-2 * (match.height / (DISPLACEMENT_SCALE * sigma)) ** 2))
    return weight, jnp.exp(-_dot(match.offset, match.offset) / (2 * sigma**2)) * match.cosine**2


@partial(jax.jit, static_argnames=("use_normals",))
def grid_scores(
    planes: Plane, sigma: Float[Array, ""], probes: Probes, grid: VoxelGrid, *, use_normals: bool = True
) -> Float[Array, " p"]:
    """Computes approximate scores of planes, with partners from the voxel grid; see `scoring.PlaneScore.score`.

    Args:
        planes: a batch of planes.
        sigma: distance between a mirror image and its partner at which the agreement falls to exp(−½), in the units of
            the points.
        probes: the points that are reflected.
        grid: the voxel grid around the surface.
        use_normals: whether the agreement includes the normal direction.
    """

    def score(plane: Plane) -> Float[Array, ""]:
        match = _match(plane, probes, grid, use_normals)
        weight, agreement = _weight_and_agreement(sigma, probes, match)
        agreeing = jnp.sum(weight * agreement)
        penalty = jnp.sum(weight * (1 - agreement) * match.penalty)
        return agreeing / (agreeing + penalty + 1e-6 * jnp.sum(probes.weight) + 1e-30)

    scores: Float[Array, " p"] = jax.lax.map(score, planes, batch_size=BATCH_SIZE)
    return scores


@partial(jax.jit, static_argnames=("point_weight", "use_normals"))
def register(
    planes: Plane,
    sigmas: Float[Array, " s"],
    probes: Probes,
    grid: VoxelGrid,
    *,
    point_weight: float,
    use_normals: bool = True,
) -> Plane:
    """Registers planes: moves each of them by one step for every σ.

    Args:
        planes: a batch of planes to start from.
        sigmas: scale σ of the residual in each step, in the units of the points.
        probes: the points that are reflected.
        grid: the voxel grid around the surface.
        point_weight: weight of the squared point-to-point distance relative to the squared point-to-plane distance. It
            keeps a plane from drifting where the surface can slide along itself.
        use_normals: whether a pair weighs less if its normals disagree.

    Returns:
        The moved planes.
    """

    def move(plane: Plane) -> Plane:
        def step(plane: Plane, sigma: Float[Array, ""]) -> tuple[Plane, None]:
            match = _match(plane, probes, grid, use_normals)
            return _gauss_newton_step(plane, sigma, probes, match, point_weight), None

        return jax.lax.scan(step, plane, sigmas)[0]

    moved: Plane = jax.lax.map(move, planes, batch_size=BATCH_SIZE)
    return moved


def _gauss_newton_step(
    plane: Plane, sigma: Float[Array, ""], probes: Probes, match: _Match, point_weight: float
) -> Plane:
    """Moves a plane by one damped step in three unknowns: two turns of the normal, and the offset."""
    v, omega = map(jnp.asarray, plane)
    weight, agreement = _weight_and_agreement(sigma, probes, match)
    weight = weight * agreement
    basis = tangent_basis(v)

    # point-to-plane: derivative of r = n·(x − 2(v·x − ω)v − y) with respect to v (one vector a row) and ω
    along = _dot(match.normal, v[None, :])
    residual = _dot(match.normal, match.offset)
    slope = -2 * (along[:, None] * probes.x + match.height[:, None] * match.normal)
    jacobian = [_dot(slope, basis[None, :, 0]), _dot(slope, basis[None, :, 1]), 2 * along]

    # point-to-point: the mirror image moves by −2(δv·x − δω)v − 2(v·x − ω)δv
    swing = [_dot(probes.x, basis[None, :, 0]), _dot(probes.x, basis[None, :, 1]), -jnp.ones_like(match.height)]
    across, off = _dot(match.offset, v[None, :]), [_dot(match.offset, basis[None, :, k]) for k in range(2)]
    lever = [match.height * off[0], match.height * off[1], jnp.zeros_like(match.height)]

    def hessian(i: int, j: int) -> Float[Array, ""]:
        square = swing[i] * swing[j] + (match.height**2 if i == j < 2 else 0)
        return jnp.sum(weight * (jacobian[i] * jacobian[j] + 4 * point_weight * square))

    def gradient(i: int) -> Float[Array, ""]:
        return jnp.sum(weight * (jacobian[i] * residual - 2 * point_weight * (swing[i] * across + lever[i])))

    turn_1, turn_2, shift = _solve_damped(
        [hessian(0, 0), hessian(0, 1), hessian(0, 2), hessian(1, 1), hessian(1, 2), hessian(2, 2)],
        [gradient(0), gradient(1), gradient(2)],
    )
    turn = jnp.sqrt(turn_1**2 + turn_2**2)
    scale = jnp.minimum(1, MAX_TURN / jnp.maximum(turn, 1e-12))
    moved = v - scale * (turn_1 * basis[:, 0] + turn_2 * basis[:, 1])
    moved = moved / jnp.sqrt(_dot(moved, moved))
    return Plane(moved, omega - jnp.clip(shift, -MAX_SHIFT, MAX_SHIFT))


def _solve_damped(
    matrix: list[Float[Array, ""]], vector: list[Float[Array, ""]]
) -> tuple[Float[Array, ""], Float[Array, ""], Float[Array, ""]]:
    """Solves a damped symmetric 3 × 3 system by Cramer's rule; the matrix is its upper triangle, row by row."""
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
