"""Export of a scale sweep as netCDF or CSV."""

import csv
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from symjax.io.atomic import replacing
from symjax.l2e.xarray_export import dataset
from symjax.scale_sweep.run import ScaleSweep

if TYPE_CHECKING:
    import xarray

AXES = "xyz"


def write(sweep: ScaleSweep, path: str | os.PathLike[str]) -> None:
    """Writes every fit, as netCDF if the file name ends in .nc and else as CSV.

    Args:
        sweep: the scale sweep.
        path: the file to write; an existing file is replaced.

    Raises:
        InvalidArgumentError: if the file cannot be written, or it is netCDF and xarray is not installed.
    """
    target = Path(path)
    with replacing(target) as temporary:
        if target.suffix.lower() == ".nc":
            as_dataset(sweep).to_netcdf(temporary, engine="scipy")
        else:
            _write_csv(sweep, temporary)


def as_dataset(sweep: ScaleSweep) -> "xarray.Dataset":
    """Returns the dataset of `Fit.to_xarray`, with σ also as a fraction of the diagonal and the ranks of the optima."""
    data = dataset(sweep.fits).assign_coords(
        fraction=("sigma", sweep.fractions, {"long_name": "sigma as a fraction of the diagonal", "units": "1"})
    )
    data["rank"] = (
        ("sigma", "restart"),
        sweep.rank,
        {"long_name": "rank by loss of the optimum reached: 0 for the best, -1 if not converged"},
    )
    found = sweep.estimated
    data.attrs |= {
        "diagonal": sweep.pairs.diagonal,
        "num_pairs": len(sweep.pairs.x),
        **{name: int(value) if isinstance(value, bool) else value for name, value in sweep.options._asdict().items()},
        "estimated_sigma": float(found.sigma),
        "estimated_normal": found.plane.normal,
        "estimated_offset": float(found.plane.offset),
        "estimated_inlier_fraction": float(found.inlier_fraction),
    }
    return data


def _write_csv(sweep: ScaleSweep, path: Path) -> None:
    """Writes one row per fit."""
    fits, shape = sweep.fits, sweep.rank.shape
    columns: dict[str, Any] = {
        "sigma": fits.sigma,
        "fraction": np.broadcast_to(sweep.fractions[:, None], shape),
        "restart": np.broadcast_to(np.arange(shape[1]), shape),
        **{f"normal_{axis}": fits.plane.normal[..., i] for i, axis in enumerate(AXES)},
        "offset": fits.plane.offset,
        "loss": fits.loss,
        "converged": np.asarray(fits.converged).astype(int),
        "rank": sweep.rank,
        "num_steps": fits.num_steps,
        "grad_norm": fits.grad_norm,
        "inlier_fraction": fits.inlier_fraction,
    }
    if fits.start is not None:
        columns |= {f"start_normal_{axis}": fits.start.normal[..., i] for i, axis in enumerate(AXES)}
        columns["start_offset"] = fits.start.offset
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows(zip(*(np.asarray(column).ravel().tolist() for column in columns.values()), strict=True))
