"""From points to their mirror plane: the bridge between the cloud's NumPy and the estimator's JAX."""

import os
from collections.abc import Callable
from typing import Literal

import numpy as np
from jaxtyping import ArrayLike, Float, Int

from symjax.detection.result import Detection, Pairs
from symjax.errors import InvalidArgumentError, InvalidPointsError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.io.points import read_points
from symjax.method.result import Finding
from symjax.method.timer import Stages
from symjax.preprocess.cloud import MAX_POINTS, Cloud, prepare
from symjax.preprocess.validation import as_points
from symjax.robust import method as robust
from symjax.symhks import method as symhks
from symjax.symhks.correspondences import SymHKS

METHODS = ("robust", "sym-hks")

MAX_PLANES = 9
"""Candidates returned: a cube has nine planes."""


def detect(
    points: Float[ArrayLike, "n 3"] | str | os.PathLike[str],
    method: str = "robust",
    *,
    normals: Float[ArrayLike, "n 3"] | None = None,
    rng: int | np.random.Generator = 0,
    init: Plane | None = None,
    max_planes: int = MAX_PLANES,
    drop_outliers: bool | None = None,
    remove_floor: bool = False,
    nonfinite: Literal["raise", "drop"] = "raise",
    max_points: int = MAX_POINTS,
    sigma: float | None = None,
    restarts: int | None = None,
    solver: str | None = None,
    options: SymHKS | None = None,
    progress: Callable[[str], None] | None = None,
) -> Detection:
    """Finds the plane of reflection symmetry of a point cloud.

    Everything reported is computed in float64; JAX's global precision is left alone.

    Args:
        points: the cloud, in any units and anywhere; or a file of it.
        method: `"robust"`: planes from many hypotheses, L2E with correspondences that follow the plane, and a
            verification on the cloud, for clouds with outliers, holes and noise. Or `"sym-hks"`: the paper's
            Algorithm 1, correspondences by heat kernel signatures made once.
        normals: surface normals of the points, of either orientation; estimated where not given.
        rng: seed, or generator, of everything random (and of the sampling, where the file is a mesh).
        init: a plane to begin with beside all others, in the units of the points (`robust`).
        max_planes: most candidates that are returned.
        drop_outliers: leave out scattered outliers first; by default `robust` does, and `sym-hks`, like the
            paper, does not.
        remove_floor: leave out the dominant plane that a scan stands on, if there is one.
        nonfinite: `"raise"`, or `"drop"` rows with NaN or infinity.
        max_points: larger clouds are thinned to this many.
        sigma: scale σ of the residual as a fraction of the cloud's diagonal (`sym-hks`); None takes it from the
            keypoints' spacing.
        restarts: number of starts (`sym-hks`), by default 64: the robust Grassmann average of the paper first, then the
            principal direction, the least-squares plane, the planes of the best single pairs, and even directions.
        solver: `"joint"`, the paper's Riemannian BFGS; `"alternating"`, as the paper applies it; or another of
            `fit_plane` (`sym-hks`): the same optimum.
        options: of the correspondences (`sym-hks`).
        progress: called with the name of every stage as it begins.

    Raises:
        SymjaxError: bad input; the subclass says which (see `symjax.errors`).
    """
    if method not in METHODS:
        raise InvalidArgumentError(f"method {method!r} is unknown: choose one of {', '.join(METHODS)}")
    if max_planes < 1:
        raise InvalidArgumentError(f"max_planes must be at least 1, not {max_planes}")
    _refuse_others(
        method,
        {"init": ("robust", init), "sigma": ("sym-hks", sigma), "restarts": ("sym-hks", restarts)}
        | {"solver": ("sym-hks", solver), "options": ("sym-hks", options)},
    )
    options = SymHKS() if options is None else options
    restarts = symhks.RESTARTS if restarts is None else restarts
    solver = "joint" if solver is None else solver
    symhks.check(options, sigma, restarts, solver)
    seed = int(rng) if isinstance(rng, (int, np.integer)) else None
    generator = np.random.default_rng(rng)
    stages = Stages(progress)
    reading: tuple[str, ...] = ()
    if isinstance(points, (str, os.PathLike)):
        with stages("reading"):
            file = read_points(points, rng=0 if seed is None else seed)
        points, reading = file.points, (file.note,) if file.note else ()
    with stages("preparing"):
        cloud = prepare(
            points,
            nonfinite=nonfinite,
            max_points=max_points,
            drop_scattered=method == "robust" if drop_outliers is None else drop_outliers,
            drop_floor=remove_floor,
        )
        given = as_points(points)
        normals = None if normals is None else _checked_normals(normals, given.shape, cloud.rows) @ cloud.frame
        prior = None if init is None else _in_cloud_units(_checked_plane(init), cloud)
    if method == "robust":
        finding = robust.find(
            cloud.points, normals=normals, prior=prior, max_planes=max_planes, rng=generator, stages=stages
        )
    else:
        finding = symhks.find(
            cloud.points,
            normals=normals,
            options=options,
            sigma=sigma,
            restarts=restarts,
            solver=solver,
            rng=generator,
            stages=stages,
        )
    return _detection(
        finding, cloud, given, method=method, max_planes=max_planes, seed=seed, reading=reading, stages=stages
    )


def _refuse_others(method: str, given: dict[str, tuple[str, object]]) -> None:
    for name, (of, value) in given.items():
        if value is not None and of != method:
            raise InvalidArgumentError(f"{name} is an option of method {of!r}, not of {method!r}")


def _detection(
    finding: Finding,
    cloud: Cloud,
    given: Float[np.ndarray, "n 3"],
    *,
    method: str,
    max_planes: int,
    seed: int | None,
    reading: tuple[str, ...],
    stages: Stages,
) -> Detection:
    """What was found, in the units of the given points."""
    candidates = tuple(c._replace(plane=_in_given_units(c.plane, cloud)) for c in finding.candidates[:max_planes])
    best, index = candidates[0], cloud.rows[finding.rows]
    axis = finding.axis
    return Detection(
        plane=best.plane,
        found=finding.symmetry != "none",
        ambiguous=finding.ambiguous,
        symmetry=finding.symmetry,
        axis=None if axis is None else (_place(axis[0], cloud), cloud.frame @ axis[1]),
        planes=tuple(_in_given_units(plane, cloud) for plane in finding.planes),
        score=best.score,
        threshold=finding.threshold,
        candidates=candidates,
        uncertainty=_uncertainty_in_given_units(finding.uncertainty, cloud),
        pairs=Pairs(given[index[:, 0]], given[index[:, 1]], index, finding.weight),
        exactness=best.exactness,
        inlier_fraction=finding.inlier_fraction,
        converged=finding.converged,
        message=finding.message,
        method=method,
        sigma=finding.sigma,
        diagonal=cloud.diagonal,
        seed=seed,
        num_points=cloud.num_given,
        used=cloud.rows,
        cleaned=cloud.cleaned,
        notes=(*reading, *cloud.notes, *finding.notes),
        timings=stages.seconds,
        points=given,
    )


def _checked_normals(
    normals: ArrayLike, shape: tuple[int, ...], rows: Int[np.ndarray, "m"]
) -> Float[np.ndarray, "m 3"]:
    array = np.asarray(normals)
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise InvalidPointsError(f"normals must be real numbers of shape {shape}, as the points, not {array.shape}")
    array = array[rows].astype(float)
    bad = ~np.isfinite(array).all(axis=1) | (np.abs(array).max(axis=1) == 0)
    if bad.any():
        raise InvalidPointsError(
            f"{int(bad.sum())} normals are zero, NaN or infinite, the first at index {int(rows[bad].min())}: "
            "leave normals out and they are estimated"
        )
    return array


def _checked_plane(plane: Plane) -> Plane:
    try:
        normal, offset = (np.asarray(part, dtype=float) for part in plane)
    except (TypeError, ValueError):
        normal, offset = np.zeros(0), np.zeros(0)
    if normal.shape != (3,) or offset.shape != () or not np.isfinite([*normal, offset]).all() or not normal.any():
        raise InvalidArgumentError(f"init must be a plane (normal of shape (3,), offset), not {plane!r}")
    length = np.linalg.norm(normal)
    return Plane(normal / length, offset / length)


def _place(point: Float[np.ndarray, "3"], cloud: Cloud) -> Float[np.ndarray, "3"]:
    """A point of the cloud in the given units."""
    return cloud.centre + cloud.diagonal * (cloud.frame @ point)


def _in_given_units(plane: Plane, cloud: Cloud) -> Plane:
    normal = cloud.frame @ plane.normal
    return Plane(normal, normal @ cloud.centre + cloud.diagonal * plane.offset).canonical()


def _in_cloud_units(plane: Plane, cloud: Cloud) -> Plane:
    return Plane(plane.normal @ cloud.frame, (plane.offset - plane.normal @ cloud.centre) / cloud.diagonal)


def _uncertainty_in_given_units(uncertainty: Uncertainty | None, cloud: Cloud) -> Uncertainty | None:
    if uncertainty is None:
        return None
    scale = np.array([1.0, 1.0, cloud.diagonal])
    # the canonical sign may have turned the normal round: turn and offset change sign together, their covariance stands
    return Uncertainty(
        uncertainty.covariance * np.outer(scale, scale),
        uncertainty.tangents @ cloud.frame.T,
        _place(uncertainty.centre, cloud),
    )
