"""Every pair is a hypothesis: the planes that single pairs propose, ranked by the criterion on a sample of pairs.

One inlier pair names the plane by itself, v = h/‖h‖ and ω = v·m, so that among n pairs with a share ρ of inliers there
are ρn right hypotheses, however small ρ is; a start that is computed from all pairs at once has no such guarantee.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import near
from symjax.l2e.criterion import Point
from symjax.l2e.features import coefficients, feature_rows
from symjax.l2e.pairs.normalised import NormalisedPairs, systematic_sample

NUM_HYPOTHESES = 1024  # pairs that propose their plane
SUBSET = 512  # pairs that the hypotheses are ranked on
LEAST_SCALE = 0.004  # radii; σ below which float32 features would rank by their rounding
SHORT = 0.3  # share of the hypotheses, those of the nearest pairs, whose direction is mostly noise
SAME_ANGLE = 5.0  # degrees within which, and
SAME_OFFSET = 0.03  # radii within which, a plane is the same as a better one
NUM_KEPT = 16  # distinct planes that are refined
NUM_OFFSETS = 8  # offsets that are tried for a given normal: more of them, or on more pairs, find no more planes
OFFSET_SUBSET = 128  # pairs that they are tried on


class PairSample(NamedTuple):
    """Some of the pairs, drawn by their weights, so that all count alike."""

    x: Float[Array, "k 3"]
    y: Float[Array, "k 3"]


def sample_pairs(pairs: NormalisedPairs, num: int) -> PairSample:
    """`num` of the pairs, see `systematic_sample`."""
    row = systematic_sample(pairs.weights, num)
    return PairSample(pairs.x[row], pairs.y[row])


class OffsetSearch(NamedTuple):
    """Finds the offset of a starting normal.

    Attributes:
        through: mid-points of a few pairs, through which offsets are tried.
        midpoints: m of the pairs that they are tried on.
        halves: h of those.
    """

    through: Float[Array, "3 j"]
    midpoints: Float[Array, "3 k"]
    halves: Float[Array, "3 k"]

    def __call__(self, v: Float[Array, " 3"], sigma: Float[Array, ""]) -> Point:
        """The plane of this normal through one of the mid-points that is best at a scale σ."""
        offsets, heights, steps = (_along(rows, v) for rows in self)
        # f/4 = (m·v − ω)² + ‖h‖² − (h·v)², where only the first term is the offset's
        rest = self.halves[0] ** 2 + self.halves[1] ** 2 + self.halves[2] ** 2 - steps**2
        exponents = -2 / sigma**2 * ((heights[None, :] - offsets[:, None]) ** 2 + rest[None, :])
        # one largest exponent for all offsets: where the rest underflows, another offset is better
        kernels = jnp.dot(jnp.exp(exponents - jnp.max(exponents)), jnp.ones_like(steps), precision="highest")
        return jnp.append(v, offsets[jnp.argmax(kernels)])


def _along(rows: Float[Array, "3 k"], v: Float[Array, " 3"]) -> Float[Array, " k"]:
    return rows[0] * v[0] + rows[1] * v[1] + rows[2] * v[2]


def offset_search(pairs: NormalisedPairs) -> OffsetSearch:
    """The search for the offsets of normals among some of the pairs."""
    few, some = sample_pairs(pairs, NUM_OFFSETS), sample_pairs(pairs, OFFSET_SUBSET)
    return OffsetSearch(0.5 * (few.x + few.y).T, 0.5 * (some.x + some.y).T, 0.5 * (some.y - some.x).T)


class Hypotheses(NamedTuple):
    """Planes that pairs propose.

    Attributes:
        points: the planes (v, ω).
        usable: those of pairs that are far enough apart.
    """

    points: Float[Array, "k 4"]
    usable: Bool[Array, " k"]


def pair_hypotheses(pairs: NormalisedPairs, num: int = NUM_HYPOTHESES) -> Hypotheses:
    """The mirror planes of single pairs."""
    x, y = sample_pairs(pairs, num)
    m, h = 0.5 * (x + y), 0.5 * (y - x)
    square = jnp.sum(h * h, axis=1)
    # where no pair has a length some plane has to be proposed
    upright = jnp.asarray([[0, 0, 1]], h.dtype)
    v = jnp.where((square > 0)[:, None], h / jnp.sqrt(jnp.where(square > 0, square, 1))[:, None], upright)
    usable = (square > 0) & (square >= jnp.quantile(square, SHORT))
    return Hypotheses(jnp.concatenate([v, jnp.sum(v * m, axis=1)[:, None]], axis=1), usable)


def rank_hypotheses(
    proposed: Hypotheses, pairs: NormalisedPairs, sigma: Float[Array, ""], *, num: int = NUM_KEPT
) -> Float[Array, "s 4"]:
    """The best distinct hypotheses at a scale σ, the best first; where there are fewer, the best again.

    They are ranked in float32, which takes a third of the time; where its rounding would count, at a larger σ.
    """
    some, scale, points = jax.tree.map(_single, (sample_pairs(pairs, SUBSET), sigma, proposed.points))
    scale = jnp.maximum(scale, LEAST_SCALE)
    phi = feature_rows(some.x, some.y)

    def value(point: Point) -> Float[Array, ""]:
        exponents = jnp.dot(-2 / scale**2 * coefficients(point[:3], point[3]), phi, precision="highest")
        largest = jnp.max(exponents)
        return -largest - jnp.log(jnp.dot(jnp.exp(exponents - largest), jnp.ones_like(exponents), precision="highest"))

    values = jax.vmap(value)(points)
    return proposed.points[plane_nms(proposed.points, jnp.where(proposed.usable, values, jnp.inf), num)]


def _single(array: Float[Array, "*s"]) -> Float[Array, "*s"]:
    return array.astype(jnp.float32)


def plane_nms(points: Float[Array, "k 4"], values: Float[Array, " k"], num: int) -> Int[Array, " num"]:
    """Rows of the lowest values, no two planes alike (non-maximum suppression); of too few, the lowest again."""
    best = jnp.argmin(values)
    planes = Plane(points[:, :3], points[:, 3])

    def take(left: Float[Array, " k"], _: None) -> tuple[Float[Array, " k"], Int[Array, ""]]:
        row = jnp.argmin(left)
        same = near(planes, Plane(points[row, :3], points[row, 3]), angle=SAME_ANGLE, offset=SAME_OFFSET)
        return jnp.where(same, jnp.inf, left), jnp.where(jnp.isfinite(left[row]), row, best)

    return jax.lax.scan(take, values, None, length=num)[1]
