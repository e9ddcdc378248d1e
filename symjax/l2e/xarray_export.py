"""A sweep as a labelled dataset (xarray, which is an extra)."""

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
"""Those of `sweep_clouds`; `sweep` has no clouds."""

ULPS = 64
"""σ is scaled and scaled back for every cloud: values this near, in units of rounding, are one σ."""

_MEANING = {
    "offset": ("distance of the plane from the origin along the normal", "units of the points"),
    "loss": ("L2E loss at the plane", "units of the points to the power -3"),
    "num_steps": ("steps of the solver", "1"),
    "grad_norm": ("norm of the Riemannian gradient, the points scaled to unit radius", "1"),
    "inlier_fraction": ("share of mirror pairs, if sigma is the scale of their residual", "1"),
}


def require_xarray() -> None:
    """Raises InvalidArgumentError where xarray is not installed."""
    if find_spec("xarray") is None:
        raise InvalidArgumentError(
            'a dataset needs xarray, which is not installed: pip install "xarray>=2024.1", '
            'or symjax with its extra, pip install ".[sweep]" in the checkout'
        )


def dataset(fit: Any) -> "xarray.Dataset":
    """The fits of a sweep as a dataset that netCDF can hold (`to_netcdf(path, engine="scipy")`).

    Dimensions are (sigma, restart), or (cloud, sigma, restart) of `sweep_clouds`. The variables are those of `Fit`:
    the plane is `normal` (along `xyz`) and `offset`, its start `start_normal` and `start_offset` (a continuation has
    none), and how a solve ended `converged` and `status`, a number that its attributes explain. σ is the coordinate
    `sigma`; where it differs between clouds, that dimension has no coordinate of its own, and σ is the coordinate
    `scale` along (cloud, sigma).

    Args:
        fit: a `Fit` with axes (S, R) or (C, S, R).

    Raises:
        InvalidArgumentError: other axes, σ that differs between restarts, or no xarray.
    """
    require_xarray()
    import xarray

    shape = fit.loss.shape
    if len(shape) not in (2, 3):
        raise InvalidArgumentError(
            f"fits with axes {shape} are no sweep: a dataset takes (sigma, restart) or (cloud, sigma, restart)"
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
        of_start = {"long_name": "unit normal of the plane that the solver began with"}
        variables["start_normal"] = ((*dims, "xyz"), np.asarray(fit.start.normal), of_start)
        of_start = {"long_name": "offset of that plane", "units": "units of the points"}
        variables["start_offset"] = (dims, np.asarray(fit.start.offset), of_start)
    coordinates: dict[str, Any] = {name: np.arange(size) for name, size in zip(dims, shape, strict=True)}
    del coordinates["sigma"]
    coordinates["xyz"] = ["x", "y", "z"]
    attributes = {"title": "mirror planes normal . x = offset", "source": f"symjax {__version__}"}
    return xarray.Dataset(variables, coordinates | _scales(np.asarray(fit.sigma)), attributes)


def _flags() -> dict[str, Any]:
    """What the numbers of `status` mean, as the CF conventions write it, and in sentences."""
    return {
        "long_name": "how the solve ended",
        "flag_values": np.array(list(Status), np.int8),
        "flag_meanings": " ".join(member.name.lower() for member in Status),
        "comment": "\n".join(f"{member.name.lower()}: {member.sentence}" for member in Status),
    }


def _scales(sigma: Float[np.ndarray, "*batch"]) -> dict[str, Any]:
    """The coordinate of σ, to the digits that its type holds, so that a decimal fraction is found as it was given."""
    rounding = np.finfo(sigma.dtype)
    low, high = sigma.min(axis=-1), sigma.max(axis=-1)
    if (high - low > ULPS * rounding.eps * high).any():
        raise InvalidArgumentError("sigma differs between the restarts of a sweep: these fits are none")
    digits = rounding.precision
    shown = np.array([float(f"{value:.{digits}g}") for value in high.ravel()], sigma.dtype).reshape(high.shape)
    meaning = {"long_name": "scale of the residual", "units": "units of the points"}
    if shown.ndim == 1:
        return {"sigma": ("sigma", shown, meaning)}
    if (np.ptp(high, axis=0) <= ULPS * rounding.eps * high.max(axis=0)).all():
        return {"sigma": ("sigma", shown[0], meaning)}
    return {"scale": (("cloud", "sigma"), shown, meaning)}
