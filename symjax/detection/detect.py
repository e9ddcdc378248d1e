"""`detect`: prepares a point cloud, runs a method on it, and transforms the result to the units of the input points."""

import os
from collections.abc import Callable
from typing import Literal

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from symjax.detection.methods import METHODS, NAMED
from symjax.detection.result import Detection, Pairs
from symjax.errors import InvalidArgumentError, MethodError
from symjax.geometry.checks import choice, whole
from symjax.geometry.point_arrays import as_points
from symjax.geometry.seeds import Seed, seeded
from symjax.io.points import read_points
from symjax.method.protocol import Method
from symjax.method.result import MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import MAX_POINTS, Cloud, prepare

MAX_PLANES = 9
"""Default limit on the candidates: a cube has nine mirror planes."""


def detect(
    points: ArrayLike | str | os.PathLike[str],
    method: str | Method = "robust",
    *,
    normals: ArrayLike | None = None,
    rng: Seed = 0,
    nonfinite: Literal["raise", "drop"] = "raise",
    max_points: int = MAX_POINTS,
    drop_outliers: bool | None = None,
    remove_ground: bool = False,
    max_planes: int = MAX_PLANES,
    progress: Callable[[str], None] | None = None,
) -> Detection:
    """Finds the mirror plane of a point cloud.

    The computation is in float64 throughout, without changing JAX's global precision.

    Args:
        points: (n, 3) points in any units; or the path of a point cloud or mesh file.
        method: `"robust"` (short for `Robust()`) is for clouds with outliers, missing parts and noise: it searches many
            hypotheses, refines the best by L2E with updated correspondences, and scores them on the whole cloud.
            `"sym-hks"` (short for `SymHKS()`) is the paper's Algorithm 1: L2E on fixed correspondences of heat kernel
            signatures. Or any `Method`, such as `Robust(init=plane)` or `SymHKS(sigma=0.05)`.
        normals: (n, 3) surface normals of the points, of any length and either orientation; estimated if None.
        rng: seed or generator of all random numbers, including those that sample the points of a mesh file.
        nonfinite: what to do with points that are NaN or infinite: `"raise"` an error, or `"drop"` them.
        max_points: limit on the points used; a larger cloud is thinned.
        drop_outliers: whether to remove scattered outliers first. None leaves the choice to the method: `Robust`
            removes them; `SymHKS`, like the paper, does not.
        remove_ground: whether to remove the ground plane of a scan, if there is one.
        max_planes: limit on the candidates and mirror planes returned.
        progress: function called with the name of each stage as it begins.

    Returns:
        The best plane, the evidence for it, and the other candidates. A cloud without symmetry raises no error: read
        `found`.

    Raises:
        SymjaxError: if the input is invalid. The subclass and the message say why (see `symjax.errors`).

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> sample = symjax.datasets.generate("quadruped", num_points=600, rng=0)  # symmetric about x = 0
        >>> det = symjax.detect(sample.points)
        >>> det.found
        True
        >>> print(np.abs(det.plane.normal).round(2), f"{abs(det.plane.offset):.2f}")
        [1. 0. 0.] 0.00
    """
    chosen = method_of(method)
    max_planes = whole("max_planes", max_planes, 1)
    seed, generator = seeded(rng)
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
        raise MethodError(f"method {chosen.name!r} returned no candidates: it must return at least one")
    return _in_given_units(
        found, cloud, given, method=chosen.name, max_planes=max_planes, seed=seed, reading=reading, timer=timer
    )


def method_of(method: str | Method) -> Method:
    """Returns the method with a given name, or the given method itself.

    Raises:
        InvalidArgumentError: if the name is unknown, or the object is not a `Method`.
    """
    if isinstance(method, str):
        choice("method", method, NAMED)
        return NAMED[method]()
    if isinstance(method, type) or not isinstance(method, Method):
        raise InvalidArgumentError(
            f"method must be one of {', '.join(METHODS)}, or a Method such as symjax.Robust(), got {method!r}"
        )
    return method


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
    """Transforms the result of a method to the frame and units of the input points."""
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
