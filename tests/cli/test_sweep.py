"""`symjax sweep`: its printed result, files, progress and errors."""

import csv
import json
import os
import sys

import click
import jax
import numpy as np
import pytest

from symjax import datasets
from symjax.cli.sigmas import Sigmas
from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import deviation_angle
from symjax.io.points import write_points

NOISE = 0.01
PLANTED = planted_pairs(np.random.default_rng(7), 240, 0.3, "wide", noise=NOISE)
SMALL = ("--sigma", "0.01:0.09:3", "--restarts", "8")


@pytest.fixture(autouse=True)
def one_at_a_time(monkeypatch):
    """One σ per batch on the existing devices, so that the tests compile one sweep."""
    jax.devices()
    monkeypatch.setattr("symjax.scale_sweep.run.SLOTS", 8)


@pytest.fixture
def pairs(tmp_path):
    path = tmp_path / "pairs.csv"
    np.savetxt(path, np.c_[PLANTED.x, PLANTED.y], delimiter=",")
    return path


@pytest.fixture
def run(run):
    """Runs `symjax sweep` and returns its exit status, stdout and stderr."""
    return lambda *arguments: run("sweep", *arguments)


def test_a_line_for_every_sigma_and_the_estimated_one(run, pairs):
    status, out, err = run(pairs, "--pairs", *SMALL, "--quiet")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    head = next(number for number, line in enumerate(lines) if line.split()[:1] == ["sigma"])
    rows = [line.split() for line in lines[head + 1 : head + 4]]
    np.testing.assert_allclose([float(row[0]) for row in rows], [0.01, 0.03, 0.09], atol=1e-5)
    for row in rows:
        assert deviation_angle(np.array(row[1:4], float), PLANTED.normal) < 3
        assert row[6].endswith("%")
        assert 1 <= int(row[7]) <= 8
    assert "240 pairs given" in out
    assert "8 starts each (fibonacci), solver newton" in out
    estimated = next(line for line in lines if line.startswith("estimated"))
    np.testing.assert_allclose(float(estimated.split()[6]), NOISE, rtol=0.15)


def test_files_and_json_agree(run, pairs, tmp_path):
    xarray = pytest.importorskip("xarray")
    outputs = {name: tmp_path / f"sweep.{name}" for name in ("nc", "csv", "html")}
    status, out, err = run(pairs, "--pairs", *SMALL, "--quiet", "--json", "--out", outputs["nc"])
    assert (status, err, out.count("\n")) == (0, "", 1)
    result = json.loads(out)
    options = ["--out", outputs["csv"], "--html", outputs["html"]]
    status, out, err = run(pairs, "--pairs", *SMALL, "--quiet", *options)
    assert (status, err) == (0, "")
    assert all(str(path) in out for path in options[1::2])
    assert outputs["html"].stat().st_size > 1e6

    with xarray.open_dataset(outputs["nc"], engine="scipy") as data:
        data.load()
    with outputs["csv"].open(newline="") as stream:
        table = {name: np.array(column, float) for name, *column in zip(*csv.reader(stream), strict=True)}
    assert data.loss.shape == (3, 8)
    for name in ("offset", "loss", "converged", "rank", "num_steps", "grad_norm", "inlier_fraction", "start_offset"):
        np.testing.assert_array_equal(table[name], data[name].values.ravel().astype(float))
    for name in ("normal", "start_normal"):
        for axis in "xyz":
            np.testing.assert_array_equal(table[f"{name}_{axis}"], data[name].sel(xyz=axis).values.ravel())
    np.testing.assert_allclose(data.fraction, [0.01, 0.03, 0.09], rtol=1e-12)
    np.testing.assert_allclose(data.sigma, data.fraction * data.attrs["diagonal"], rtol=1e-12)

    lowest = data.loss.where(data.converged)
    np.testing.assert_allclose([row["loss"] for row in result["sweep"]], lowest.min("restart"))
    np.testing.assert_allclose([row["converged"] for row in result["sweep"]], data.converged.mean("restart"))
    assert [row["optima"] for row in result["sweep"]] == (data["rank"].max("restart") + 1).values.tolist()
    assert result["estimated"]["normal"] == data.attrs["estimated_normal"].tolist()
    assert (result["num_pairs"], result["start"], result["restarts"]) == (240, "fibonacci", 8)


def test_a_scan_is_swept_by_its_correspondences(run, tmp_path):
    rng = np.random.default_rng(3)
    cloud = datasets.pose(datasets.generate("quadruped", num_points=1500, rng=rng), rng)
    path = tmp_path / "scan.ply"
    write_points(path, cloud.points)
    status, out, _ = run(path, *SMALL, "--quiet", "--json")
    result = json.loads(out)
    assert status == 0
    assert result["reading"]["note"] == "cloud of 1500 points"
    assert "by Sym-HKS" in result["notes"][0]
    assert deviation_angle(np.array(result["sweep"][1]["normal"]), cloud.normals[0]) < 5


def test_random_starts_follow_the_seed(run, pairs):
    options = (pairs, "--pairs", *SMALL, "--quiet", "--json", "--start", "random", "--seed")
    first, again, other = (json.loads(run(*options, seed)[1])["sweep"] for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_progress_counts_the_sigmas(run, pairs, monkeypatch):
    plain = run(pairs, "--pairs", *SMALL)[2].splitlines()
    assert plain[0] == "symjax: sweeping sigma ..."
    assert [line.split(" done, ")[0] for line in plain[1:3]] == ["symjax: 1 of 3", "symjax: 2 of 3"]
    assert plain[3:] == ["symjax: estimating sigma ..."]
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    bar = run(pairs, "--pairs", *SMALL)[2]
    for part in ("reading", "sweeping sigma 0/3", "sweeping sigma 2/3", "sweeping sigma 3/3", "left"):
        assert part in bar


def test_errors_are_one_line_and_status_2(run, pairs, tmp_path, monkeypatch):
    (tmp_path / "old.csv").write_text("mine")
    bad = tmp_path / "bad.csv"
    bad.write_text("1,2,3,4,5,nan\n" * 5)
    for arguments, why in [
        ([tmp_path / "none.ply"], "No such file"),
        ([tmp_path / "none.csv", "--pairs"], "No such file"),
        ([tmp_path, "--pairs"], "it is a folder"),
        ([pairs, "--pairs", "--out", tmp_path / "a.json"], "must end in .nc or .csv"),
        ([pairs, "--pairs", "--out", tmp_path / "old.csv"], "use --force"),
        ([pairs, "--pairs", "--html", pairs, "--force"], "it is also the input or another output"),
        ([pairs, "--pairs", "--sigma", "0"], "a scale must be a positive, finite fraction of the diagonal, got 0"),
        ([pairs, "--pairs", "--restarts", 0], "--restarts"),
        ([pairs, "--pairs", "--start", "best"], "'best' is not one of"),
        ([bad, "--pairs"], "5 of 5 pairs are NaN"),
        ([bad, "--pairs", "--nonfinite", "drop"], "0 pairs are too few"),
        ([], "Missing argument 'FILE'"),
    ]:
        status, out, err = run(*arguments)
        assert (status, out) == (2, "")
        assert err.startswith("symjax: error: ")
        assert err.count("\n") == 1
        assert why in err
    assert (tmp_path / "old.csv").read_text() == "mine"
    monkeypatch.setitem(sys.modules, "xarray", None)
    status, out, err = run(pairs, "--pairs", "--out", tmp_path / "a.nc")
    assert (status, out) == (2, "")
    assert "pip install" in err


@pytest.mark.parametrize(
    ("text", "sigmas"),
    [
        ("0.05", (0.05,)),
        ("0.2,0.05, 0.1", (0.05, 0.1, 0.2)),
        ("0.1,0.1", (0.1,)),
        ("0.01:1:3", (0.01, 0.1, 1)),
        ("1:0.01:3", (0.01, 0.1, 1)),
        ("0.3:0.5:1", (0.3,)),
        ("1e-3:0.2:2", (0.001, 0.2)),
    ],
)
def test_scales_are_a_range_or_a_list(text, sigmas):
    np.testing.assert_allclose(Sigmas().convert(text, None, None), sigmas, rtol=1e-14)


@pytest.mark.parametrize(
    "text", ["", "a", "1:2", "1:2:3:4", "1:2:0", "1:2:x", "-1:2:3", "0:1:4", "nan", "inf", "0.1,", "1:inf:3", "1:2:1e9"]
)
def test_other_scales_are_refused(text):
    with pytest.raises(click.BadParameter):
        Sigmas().convert(text, None, None)


@pytest.mark.parametrize(
    ("arguments", "absent"),
    [
        (["--help"], {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["nowhere.ply"], {"jax", "scipy", "trimesh", "plotly"}),
        (["nowhere.csv", "--pairs"], {"jax", "scipy", "trimesh", "plotly", "xarray"}),
    ],
)
def test_nothing_slow_is_imported_before_the_file_is_read(modules_after, arguments, absent):
    assert not absent & modules_after("sweep", *arguments)[1]


DEVICES = """
from symjax.cli.start import start_jax
{}
start_jax(cache=False, all_cores=True)
print(len(jax.devices()))
"""


@pytest.mark.skipif(not hasattr(os, "sched_getaffinity"), reason="the number of available cores is unknown here")
def test_every_core_is_a_device_unless_the_user_sets_their_number(fresh):
    cpu, cores = {"JAX_PLATFORMS": "cpu"}, len(os.sched_getaffinity(0))
    program = DEVICES.format("import jax")
    assert fresh(program, **cpu)[1] == f"{cores}\n"
    assert fresh(program, **cpu, JAX_NUM_CPU_DEVICES="3")[1] == "3\n"
    assert fresh(program, **cpu, XLA_FLAGS="--xla_force_host_platform_device_count=3")[1] == "3\n"
    assert fresh(DEVICES.format("import jax; jax.devices()"), **cpu)[1] == "1\n"
