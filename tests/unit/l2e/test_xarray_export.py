"""Sweeps as datasets: all fields of the fits, and a round trip through netCDF."""

import sys

import jax
import numpy as np
import pytest

from symjax import best, sweep, sweep_clouds
from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError
from symjax.l2e.status import Status
from symjax.l2e.xarray_export import require_xarray

xarray = pytest.importorskip("xarray")

SIGMAS = (0.02, 0.05, 0.2)
RESTARTS = 8


def pairs(seed, num=100):
    planted = planted_pairs(np.random.default_rng(seed), num, 0.5)
    return planted.x, planted.y


@pytest.fixture(scope="module")
def fits():
    return sweep(*pairs(0), SIGMAS, "fibonacci", restarts=RESTARTS)


@pytest.fixture(scope="module")
def clouds():
    return sweep_clouds([pairs(0), pairs(1, 70)], SIGMAS, "fibonacci", restarts=RESTARTS)


@pytest.mark.parametrize(("name", "dims"), [("fits", ("sigma", "restart")), ("clouds", ("cloud", "sigma", "restart"))])
def test_the_dataset_holds_all_fields(request, name, dims):
    fit = request.getfixturevalue(name)
    data = fit.to_xarray()
    assert dict(data.sizes) == dict(zip((*dims, "xyz"), (*fit.loss.shape, 3), strict=True))
    assert data.normal.dims == (*dims, "xyz")
    np.testing.assert_array_equal(data.normal, fit.plane.normal)
    np.testing.assert_array_equal(data.offset, fit.plane.offset)
    assert data.start_normal.dims == (*dims, "xyz")
    np.testing.assert_array_equal(data.start_normal, fit.start.normal)
    np.testing.assert_array_equal(data.start_offset, fit.start.offset)
    for variable in ("loss", "converged", "num_steps", "grad_norm", "inlier_fraction"):
        assert data[variable].dims == dims
        np.testing.assert_array_equal(data[variable], getattr(fit, variable))
    for variable in data.values():
        assert variable.attrs["long_name"]


def test_sigma_is_found_as_it_was_given(fits, clouds):
    for fit in (fits, clouds):
        assert fit.to_xarray().sigma.dims == ("sigma",)
        assert tuple(fit.to_xarray().sigma.values) == SIGMAS
    single = jax.tree.map(lambda leaf: leaf.astype(np.float32) if leaf.dtype == np.float64 else leaf, fits)
    np.testing.assert_array_equal(single.to_xarray().sigma, np.float32(SIGMAS))


def test_selecting_is_indexing(fits):
    data = fits.to_xarray()
    np.testing.assert_array_equal(data.loss.sel(sigma=0.05), fits.loss[1])
    chosen = data.isel(restart=data.loss.where(data.converged).argmin("restart"))
    np.testing.assert_array_equal(chosen.normal, best(fits).plane.normal)


def test_clouds_are_the_sweeps_of_each(fits, clouds):
    of_first = clouds.to_xarray().sel(cloud=0, drop=True)
    xarray.testing.assert_equal(of_first, fits.to_xarray())


def test_sigma_that_differs_between_clouds_is_kept(fits):
    factors = np.array([1.0, 3.0])
    scaled = [fits._replace(sigma=factor * fits.sigma) for factor in factors]
    data = jax.tree.map(lambda *leaves: np.stack(leaves), *scaled).to_xarray()
    assert "sigma" not in data.coords
    assert data.scale.dims == ("cloud", "sigma")
    np.testing.assert_allclose(data.scale, factors[:, None] * SIGMAS, rtol=1e-14)


def test_how_a_solve_ended_is_explained(fits):
    stopped = sweep(*pairs(0), SIGMAS, "fibonacci", restarts=RESTARTS, max_steps=0)
    for fit in (fits, stopped):
        status = fit.to_xarray().status
        said = dict(line.split(": ", 1) for line in status.attrs["comment"].split("\n"))
        names = dict(zip(status.attrs["flag_values"].tolist(), status.attrs["flag_meanings"].split(), strict=True))
        for code, message in zip(status.values.ravel().tolist(), np.ravel(fit.message), strict=True):
            assert message.startswith(said[names[code]])
    assert not stopped.to_xarray().converged.any()
    assert (stopped.status == Status.MAX_STEPS_REACHED).any()


@pytest.mark.parametrize("name", ["fits", "clouds"])
def test_netcdf_round_trip(request, name, tmp_path):
    data = request.getfixturevalue(name).to_xarray()
    data.to_netcdf(tmp_path / "sweep.nc", engine="scipy")
    with xarray.open_dataset(tmp_path / "sweep.nc", engine="scipy") as back:
        xarray.testing.assert_identical(back.load(), data)


def test_fits_that_are_not_a_sweep_are_refused(fits):
    for other in (best(fits), jax.tree.map(lambda leaf: leaf[0, 0], fits), jax.tree.map(lambda a: a[None, None], fits)):
        with pytest.raises(InvalidArgumentError, match=r"fits with axes \(.*\) are not a sweep"):
            other.to_xarray()
    spread = np.asarray(fits.sigma) * np.linspace(1, 2, RESTARTS)
    with pytest.raises(InvalidArgumentError, match="sigma differs between the restarts"):
        fits._replace(sigma=spread).to_xarray()


def test_without_xarray_the_error_says_what_to_install(fits, monkeypatch):
    require_xarray()
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(InvalidArgumentError, match=r'pip install "xarray>=2024\.1"'):
        fits.to_xarray()
