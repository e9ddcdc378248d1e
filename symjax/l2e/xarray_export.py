"""Converts a sweep to a labelled dataset of xarray, which is an optional dependency."""

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from symjax import __version__
from symjax.errors import InvalidArgumentError
from symjax.l2e.status import Status

if TYPE_CHECKING:
    import xarray


DIMENSIONS = ("cloud", "sigma", "restart")
"""Dimensions of `sweep_clouds`; `sweep` has the last two."""

ULPS = 64
"""Values of σ that differ by at most this many units of rounding count as equal: every cloud scales σ and back."""

_MEANING = {
    "offset": ("distance of the plane from the origin along the normal", "units of the points"),
    "loss": ("L2E loss at the plane", "units of the points to the power -3"),
    "num_steps": ("steps of the solver", "1"),
    "grad_norm": ("norm of the Riemannian gradient, with the points scaled to unit radius", "1"),
    "inlier_fraction": ("fraction of inliers, if sigma is the scale of their residual", "1"),
}


def require_xarray() -> None:
    """Raises InvalidArgumentError if xarray is not installed."""
    if find_spec("xarray") is None:
        raise InvalidArgumentError(
            'a dataset needs xarray, which is not installed: pip install "xarray>=2024.1", '
            'or install symjax with its extra, pip install ".[sweep]" in the checkout'
        )


def dataset(fit: Any) -> "xarray.Dataset":
    """Converts the fits of a sweep to a dataset that can be saved as netCDF (`to_netcdf(path, engine="scipy")`).

    The dimensions are (sigma, restart), or (cloud, sigma, restart) for `sweep_clouds`. The variables hold the fields of
    `Fit`. The plane is `normal` (along the dimension `xyz`) and `offset`. Its start is `start_normal` and
    `start_offset`, which a continuation does not have. `converged` and `status` say how the solver ended; the
    attributes of `status` explain its numbers. σ is the coordinate `sigma`. If σ differs between clouds, the dimension
    `sigma` has no coordinate, and σ is the coordinate `scale` along (cloud, sigma).

    Args:
        fit: a `Fit` with axes (S, R) or (C, S, R).

    Returns:
        The dataset.

    Raises:
        InvalidArgumentError: if the fit has other axes, if σ differs between restarts, or if xarray is not installed.
    """
    require_xarray()
    import xarray

    shape = fit.loss.shape
    if len(shape) not in (2, 3):
        raise InvalidArgumentError(
            f"fits with axes {shape} are not a sweep: the axes must be (sigma, restart) or (cloud, sigma, restart)"
        )
    dims = DIMENSIONS[-len(shape) :]
    values = {name: np.asarray(getattr(fit, name)) for name in _MEANING if name != "offset"}
    values["offset"] = np.asarray(fit.plane.offset)
    variables: dict[str, Any] = {
        "normal": ((*dims, "xyz"), np.asarray(fit.plane.normal), {"long_name": "unit normal of the plane"}),
        **{
            name: (dims, values[name], {"long_name": meaning, "units": units})
            for name, (meaning, units) in _MEANING.items()
        },
        "converged": (dims, np.asarray(fit.converged), {"long_name": "whether the solver converged"}),
        "status": (dims, np.asarray(fit.status).astype(np.int8), _flags()),
    }
    if fit.start is not None:
        attributes = {"long_name": "unit normal of the plane that the solver began with"}
        variables["start_normal"] = ((*dims, "xyz"), np.asarray(fit.start.normal), attributes)
        attributes = {"long_name": "offset of the plane that the solver began with", "units": "units of the points"}
        variables["start_offset"] = (dims, np.asarray(fit.start.offset), attributes)
    coordinates: dict[str, Any] = {name: np.arange(size) for name, size in zip(dims, shape, strict=True)}
    del coordinates["sigma"]
    coordinates["xyz"] = ["x", "y", "z"]
    attributes = {"title": "mirror planes normal . x = offset", "source": f"symjax {__version__}"}
    return xarray.Dataset(variables, coordinates | _scales(np.asarray(fit.sigma)), attributes)


def _flags() -> dict[str, Any]:
    """Returns attributes that explain the numbers of `status`, by the CF conventions and in sentences."""
    return {
        "long_name": "how the solver ended",
        "flag_values": np.array(list(Status), np.int8),
        "flag_meanings": " ".join(member.name.lower() for member in Status),
        "comment": "\n".join(f"{member.name.lower()}: {member.sentence}" for member in Status),
    }


def _scales(sigma: Float[np.ndarray, "*batch"]) -> dict[str, Any]:
    """Returns σ as a coordinate, rounded to the digits of its type so that a decimal fraction is selected as given."""
    precision = np.finfo(sigma.dtype)
    low, high = sigma.min(axis=-1), sigma.max(axis=-1)
    if (high - low > ULPS * precision.eps * high).any():
        raise InvalidArgumentError("sigma differs between the restarts: these fits do not come from one sweep")
    digits = precision.precision
    rounded = np.array([float(f"{value:.{digits}g}") for value in high.ravel()], sigma.dtype).reshape(high.shape)
    meaning = {"long_name": "scale of the residual", "units": "units of the points"}
    if rounded.ndim == 1:
        return {"sigma": ("sigma", rounded, meaning)}
    if (np.ptp(high, axis=0) <= ULPS * precision.eps * high.max(axis=0)).all():
        return {"sigma": ("sigma", rounded[0], meaning)}
    return {"scale": (("cloud", "sigma"), rounded, meaning)}
