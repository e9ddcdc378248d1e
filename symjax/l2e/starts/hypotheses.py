"""Hypotheses: the mirror planes of single pairs, ranked by the criterion on a sample of the pairs.

One inlier determines the plane by itself: v = h/‖h‖ and ω = v·m. Among n pairs with an inlier fraction ρ there are
therefore ρn correct hypotheses, however small ρ is. A start that is computed from all pairs has no such guarantee.
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

NUM_HYPOTHESES = 1024  # pairs that propose a plane
NUM_RANKING_PAIRS = 512  # pairs that the hypotheses are ranked on
MIN_RANKING_SIGMA = 0.004  # in radii: at smaller σ, rounding errors of the float32 features would decide the ranking
SHORT_FRACTION = 0.3  # fraction of the hypotheses that is dropped: the shortest pairs' directions are mostly noise
SAME_ANGLE = 5.0  # in degrees, and
SAME_OFFSET = 0.03  # in radii: planes closer than both count as the same
NUM_KEPT = 16  # distinct planes that are refined
NUM_OFFSETS = 8  # offsets tried for a given normal: trying more, or ranking on more pairs, finds no more planes
NUM_OFFSET_PAIRS = 128  # pairs that these offsets are ranked on


class PairSample(NamedTuple):
    """A sample of the pairs, drawn in proportion to their weights, so that all of them count equally."""

    x: Float[Array, "k 3"]
    y: Float[Array, "k 3"]


def sample_pairs(pairs: NormalisedPairs, num: int) -> PairSample:
    """Draws `num` of the pairs by `systematic_sample`."""
    row = systematic_sample(pairs.weights, num)
    return PairSample(pairs.x[row], pairs.y[row])


class OffsetSearch(NamedTuple):
    """Search for the offset of a starting normal.

    Attributes:
        candidates: mid-points of a few pairs; the planes through them are tried.
        midpoints: mid-points m of the pairs that the offsets are ranked on.
        half_differences: half differences h of these pairs.
    """

    candidates: Float[Array, "3 j"]
    midpoints: Float[Array, "3 k"]
    half_differences: Float[Array, "3 k"]

    def __call__(self, v: Float[Array, " 3"], sigma: Float[Array, ""]) -> Point:
        """Returns the best plane at scale σ that has this normal and contains one of the candidates."""
        offsets, along_m, along_h = (_along(rows, v) for rows in self)
        # f/4 = (m·v − ω)² + ‖h‖² − (h·v)², where only the first term depends on the offset
        h = self.half_differences
        rest = h[0] ** 2 + h[1] ** 2 + h[2] ** 2 - along_h**2
        exponents = -2 / sigma**2 * ((along_m[None, :] - offsets[:, None]) ** 2 + rest[None, :])
        # one largest exponent for all offsets: if the kernels of an offset all underflow, another offset is better
        kernels = jnp.dot(jnp.exp(exponents - jnp.max(exponents)), jnp.ones_like(along_h), precision="highest")
        return jnp.append(v, offsets[jnp.argmax(kernels)])


def _along(rows: Float[Array, "3 k"], v: Float[Array, " 3"]) -> Float[Array, " k"]:
    return rows[0] * v[0] + rows[1] * v[1] + rows[2] * v[2]


def offset_search(pairs: NormalisedPairs) -> OffsetSearch:
    """Makes the search for the offsets of normals, on a sample of the pairs."""
    few, sample = sample_pairs(pairs, NUM_OFFSETS), sample_pairs(pairs, NUM_OFFSET_PAIRS)
    return OffsetSearch(0.5 * (few.x + few.y).T, 0.5 * (sample.x + sample.y).T, 0.5 * (sample.y - sample.x).T)


class Hypotheses(NamedTuple):
    """Planes proposed by single pairs.

    Attributes:
        points: the planes (v, ω).
        usable: whether the two points of the pair are far enough apart.
    """

    points: Float[Array, "k 4"]
    usable: Bool[Array, " k"]


def pair_hypotheses(pairs: NormalisedPairs, num: int = NUM_HYPOTHESES) -> Hypotheses:
    """Computes the mirror planes of `num` single pairs."""
    x, y = sample_pairs(pairs, num)
    m, h = 0.5 * (x + y), 0.5 * (y - x)
    square = jnp.sum(h * h, axis=1)
    # a pair of length zero proposes an arbitrary plane, which is not usable
    arbitrary = jnp.asarray([[0, 0, 1]], h.dtype)
    v = jnp.where((square > 0)[:, None], h / jnp.sqrt(jnp.where(square > 0, square, 1))[:, None], arbitrary)
    usable = (square > 0) & (square >= jnp.quantile(square, SHORT_FRACTION))
    return Hypotheses(jnp.concatenate([v, jnp.sum(v * m, axis=1)[:, None]], axis=1), usable)


def rank_hypotheses(
    proposed: Hypotheses, pairs: NormalisedPairs, sigma: Float[Array, ""], *, num: int = NUM_KEPT
) -> Float[Array, "s 4"]:
    """Returns the best distinct hypotheses at a scale σ, in order. If there are fewer than `num`, the best is repeated.

    The ranking uses float32, which takes a third of the time of float64. It uses at least the scale
    `MIN_RANKING_SIGMA`.
    """
    sample, scale, points = jax.tree.map(_single, (sample_pairs(pairs, NUM_RANKING_PAIRS), sigma, proposed.points))
    scale = jnp.maximum(scale, MIN_RANKING_SIGMA)
    phi = feature_rows(sample.x, sample.y)

    def value(point: Point) -> Float[Array, ""]:
        exponents = jnp.dot(-2 / scale**2 * coefficients(point[:3], point[3]), phi, precision="highest")
        largest = jnp.max(exponents)
        return -largest - jnp.log(jnp.dot(jnp.exp(exponents - largest), jnp.ones_like(exponents), precision="highest"))

    values = jax.vmap(value)(points)
    return proposed.points[plane_nms(proposed.points, jnp.where(proposed.usable, values, jnp.inf), num)]


def _single(array: Float[Array, "*s"]) -> Float[Array, "*s"]:
    return array.astype(jnp.float32)


def plane_nms(points: Float[Array, "k 4"], values: Float[Array, " k"], num: int) -> Int[Array, " num"]:
    """Returns the rows of the `num` lowest values of distinct planes, by non-maximum suppression.

    If there are fewer distinct planes of finite value, the row of the lowest value is repeated.
    """
    best = jnp.argmin(values)
    planes = Plane(points[:, :3], points[:, 3])

    def take_lowest(remaining: Float[Array, " k"], _: None) -> tuple[Float[Array, " k"], Int[Array, ""]]:
        row = jnp.argmin(remaining)
        same = near(planes, Plane(points[row, :3], points[row, 3]), angle=SAME_ANGLE, offset=SAME_OFFSET)
        return jnp.where(same, jnp.inf, remaining), jnp.where(jnp.isfinite(remaining[row]), row, best)

    return jax.lax.scan(take_lowest, values, None, length=num)[1]
