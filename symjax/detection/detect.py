"""From points to their mirror planes: a cloud is prepared, a method looks at it, the answer is brought back."""

import os
from collections.abc import Callable
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from symjax.detection.result import Detection, Pairs
from symjax.errors import InvalidArgumentError, MethodError
from symjax.geometry.checks import choice, whole
from symjax.io.points import read_points
from symjax.method.protocol import Method
from symjax.method.result import MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import MAX_POINTS, Cloud, prepare
from symjax.preprocess.validation import as_points
from symjax.robust.method import Robust
from symjax.symhks.method import SymHKS

NAMED: dict[str, type[Robust] | type[SymHKS]] = {"robust": Robust, "sym-hks": SymHKS}

METHODS = tuple(NAMED)
"""The names of methods."""

MAX_PLANES = 9
"""Candidates returned: a cube has nine planes."""


def detect(
    points: ArrayLike | str | os.PathLike[str],
    method: str | Method = "robust",
    *,
    normals: ArrayLike | None = None,
    rng: int | np.integer | np.random.Generator = 0,
    nonfinite: Literal["raise", "drop"] = "raise",
    max_points: int = MAX_POINTS,
    drop_outliers: bool | None = None,
    remove_ground: bool = False,
    max_planes: int = MAX_PLANES,
    progress: Callable[[str], None] | None = None,
) -> Detection:
    """Finds the plane of reflection symmetry of a point cloud.

    Everything reported is computed in float64; JAX's global precision is left alone.

    Args:
        points: the cloud, in any units and anywhere; or a file of it.
        method: `"robust"`, short for `Robust()`: planes from many hypotheses, L2E with correspondences that follow the
            plane, and a verification on the cloud, for clouds with outliers, holes and noise. `"sym-hks"`, short for
            `SymHKS()`: the paper's Algorithm 1, correspondences by heat kernel signatures made once. Or any `Method`,
            such as `Robust(init=plane)` or `SymHKS(sigma=0.05)`.
        normals: surface normals of the points, of either orientation; estimated where not given.
        rng: seed, or generator, of everything random (and of the sampling, where the file is a mesh).
        nonfinite: `"raise"`, or `"drop"` rows with NaN or infinity.
        max_points: larger clouds are thinned to this many.
        drop_outliers: leave out scattered outliers first; None leaves it to the method: `Robust` does, and `SymHKS`,
            like the paper, does not.
        remove_ground: leave out the dominant plane that a scan stands on, if there is one.
        max_planes: most candidates that are returned.
        progress: called with the name of every stage as it begins.

    Raises:
        SymjaxError: bad input; the subclass says which (see `symjax.errors`).

    Example:
        >>> import symjax
        >>> sample = symjax.datasets.generate("mug", num_points=1000, rng=0)
        >>> det = symjax.detect(sample.points)  # doctest: +SKIP
        >>> det.plane.normal, det.found  # doctest: +SKIP
    """
    chosen = method_of(method)
    max_planes = whole("max_planes", max_planes, 1)
    seed, generator = _seeded(rng)
    timer = StageTimer(progress)
    reading: tuple[str, ...] = ()
    if isinstance(points, (str, os.PathLike)):
        with timer.stage("reading"):
            file = read_points(points, rng=generator if seed is None else seed)
        points, reading = file.points, (file.note,) if file.note else ()
    with timer.stage("preparing"):
        cloud = prepare(
            points,
            normals=normals,
            nonfinite=nonfinite,
            max_points=max_points,
            drop_outliers=chosen.drops_outliers if drop_outliers is None else drop_outliers,
            remove_ground=remove_ground,
        )
        given = as_points(points)
    found = chosen.find(cloud, max_planes=max_planes, rng=generator, timer=timer)
    if not found.candidates:
        raise MethodError(f"the method {chosen.name!r} returned no candidate: at least one is needed")
    return _in_given_units(
        found, cloud, given, method=chosen.name, max_planes=max_planes, seed=seed, reading=reading, timer=timer
    )


def method_of(method: str | Method) -> Method:
    """The method of a name, or the method itself.

    Raises:
        InvalidArgumentError: an unknown name, or an object that is no `Method`.
    """
    if isinstance(method, str):
        choice("method", method, NAMED)
        return NAMED[method]()
    if isinstance(method, type) or not isinstance(method, Method):
        raise InvalidArgumentError(f"method must be a name or a Method, such as symjax.Robust(), not {method!r}")
    return method


def _seeded(rng: int | np.integer | np.random.Generator) -> tuple[int | None, np.random.Generator]:
    """The seed, None for a generator; and the generator."""
    if isinstance(rng, np.random.Generator):
        return None, rng
    if isinstance(rng, (int, np.integer)) and not isinstance(rng, bool) and rng >= 0:
        return int(rng), np.random.default_rng(int(rng))
    raise InvalidArgumentError(f"rng must be a seed (a whole number, at least 0) or a numpy Generator, not {rng!r}")


def _in_given_units(
    found: MethodResult,
    cloud: Cloud,
    given: Float[np.ndarray, "n 3"],
    *,
    method: str,
    max_planes: int,
    seed: int | None,
    reading: tuple[str, ...],
    timer: StageTimer,
) -> Detection:
    """What was found, in the units of the given points."""
    to_given = cloud.to_given
    candidates = tuple(c._replace(plane=to_given.plane(c.plane).canonical()) for c in found.candidates[:max_planes])
    best, index = candidates[0], cloud.rows[found.rows]
    axis = found.axis
    return Detection(
        plane=best.plane,
        found=found.symmetry != "none",
        ambiguous=found.ambiguous,
        symmetry=found.symmetry,
        axis=None if axis is None else to_given.axis(axis),
        planes=tuple(to_given.plane(plane).canonical() for plane in found.planes[:max_planes]),
        score=best.score,
        threshold=found.threshold,
        candidates=candidates,
        uncertainty=None if found.uncertainty is None else to_given.uncertainty(found.uncertainty),
        pairs=Pairs(given[index[:, 0]], given[index[:, 1]], index, found.weight),
        exactness=best.exactness,
        inlier_weight=found.inlier_weight,
        inlier_fraction=found.inlier_fraction,
        converged=found.converged,
        message=found.message,
        method=method,
        sigma=found.sigma,
        diagonal=cloud.diagonal,
        seed=seed,
        num_points=cloud.num_given,
        used=cloud.rows,
        cleaned=cloud.cleaned,
        notes=(*reading, *cloud.notes, *found.notes),
        timings=timer.seconds,
        points=given,
    )
