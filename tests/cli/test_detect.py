"""The command line: what it prints, what it writes, and how it fails. The detection itself is a stand-in here."""

import json
import subprocess
import sys
import warnings

import numpy as np
import pytest

import symjax
from symjax import cli
from symjax.cli.progress import CHECKING
from symjax.detection import detect
from symjax.detection.result import Candidate, Detection, Pairs
from symjax.errors import ComponentsWarning, DegenerateCloudError
from symjax.geometry.plane import Plane
from symjax.io.points import read_points, write_points
from symjax.symhks.method import RESTARTS

PLANE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.25))
STAGES = ("preparing", "fitting")


def fake_detect(
    points, method="robust", *, rng=0, sigma=0.03, restarts=64, nonfinite="raise", progress=None, **options
):
    """What `detect` would give for a cloud whose mirror plane is x = 0.25."""
    for stage in STAGES:
        progress(stage)
    index = np.array([[0, 1], [2, 3], [4, 5]])
    return Detection(
        plane=PLANE,
        found=True,
        ambiguous=False,
        symmetry="one plane",
        axis=None,
        planes=(PLANE,),
        uncertainty=None,
        exactness=None,
        score=0.7,
        threshold=0.3,
        candidates=(Candidate(PLANE, 0.7, 0.7),),
        pairs=Pairs(points[index[:, 0]], points[index[:, 1]], index, np.array([1.0, 0.5, 0.0])),
        inlier_weight=0.5,
        inlier_fraction=2 / 3,
        converged=True,
        message="The gradient is zero to the tolerance.",
        method=method,
        sigma=sigma,
        diagonal=2.0,
        seed=rng,
        num_points=len(points),
        used=np.arange(len(points)),
        cleaned=False,
        notes=(f"restarts {restarts}, nonfinite {nonfinite}", *(f"{k} {v}" for k, v in options.items() if v)),
        timings=dict.fromkeys(STAGES, 0.5),
        points=points,
    )


@pytest.fixture
def scan(tmp_path, rng):
    path = tmp_path / "scan.ply"
    write_points(path, rng.normal(size=(60, 3)))
    return path


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(detect, "detect", fake_detect)


@pytest.fixture
def run(capsys):
    """Runs the command and gives its exit status, stdout and stderr."""

    def call(*arguments):
        with pytest.raises(SystemExit) as ended:
            cli.main([str(argument) for argument in arguments])
        return ended.value.code or 0, *capsys.readouterr()

    return call


def modules_after(*arguments):
    """Exit status and the modules imported by a run of the command in a fresh interpreter."""
    code = (
        "import sys\nfrom symjax import cli\n"
        "try: cli.main(sys.argv[1:])\n"
        "finally: print('MODULES', *sorted(sys.modules), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)
    return done.returncode, set(done.stderr.rsplit("MODULES", 1)[1].split())


@pytest.mark.parametrize(
    ("arguments", "status", "absent"),
    [
        (["--help"], 0, {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["detect", "--help"], 0, {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["--version"], 0, {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["detect", "nowhere.ply"], 2, {"jax", "scipy", "trimesh", "plotly"}),
    ],
)
def test_help_and_file_errors_import_nothing_slow(arguments, status, absent):
    returned, modules = modules_after(*arguments)
    assert returned == status
    assert not absent & modules


def test_text_has_the_plane_and_what_to_think_of_it(run, fake, scan):
    status, out, err = run("detect", scan, "--quiet")
    assert (status, err) == (0, "")
    lines = dict(line.split(None, 1) for line in out.splitlines())
    assert lines["normal"] == "+1.000000  +0.000000  +0.000000"
    assert lines["offset"].startswith("+0.25 ")
    assert lines["found"].startswith("yes")
    assert "score 0.700, above the threshold 0.300" in lines["found"]
    assert lines["inliers"] == "66.7% of 3 pairs"
    assert "The gradient is zero" in lines["converged"]
    assert lines["note"] == "restarts 64, nonfinite raise"
    assert "cloud of 60 points" in lines["file"]
    assert "preparing 0.50" in lines["seconds"]


def test_json_is_one_object_and_nothing_else(run, fake, scan):
    status, out, _ = run("detect", scan, "--json", "--seed", 7, "--sigma", 0.05)
    values = json.loads(out)
    assert status == 0
    assert out.count("\n") == 1
    assert values["plane"] == {"normal": [1.0, 0.0, 0.0], "offset": 0.25}
    assert (values["seed"], values["sigma"]) == (7, 0.05)
    assert values["file"] == str(scan)
    assert values["reading"]["note"] == "cloud of 60 points"


def test_options_reach_detect(run, fake, scan):
    _, out, _ = run("detect", scan, "--restarts", 5, "--nonfinite", "drop")
    assert "restarts 5, nonfinite drop" in out


def test_options_of_the_robust_method_reach_detect(run, fake, scan):
    _, out, _ = run("detect", scan, "--init", 1, 0, 0, 0.5, "--remove-floor", "--max-planes", 3)
    assert "init ((1.0, 0.0, 0.0), 0.5)" in out
    assert "remove_ground True" in out
    assert "max_planes 3" in out
    assert "drop_outliers" not in out


def test_help_states_the_default_of_detect(run):
    _, out, _ = run("detect", "--help")
    assert f"[default: {RESTARTS}]" in out
    assert f"[default: {detect.MAX_PLANES}]" in out


def test_outputs_are_written_and_not_replaced_without_force(run, fake, scan, tmp_path):
    outputs = {name: tmp_path / f"out.{name}" for name in ("html", "png", "ply", "json")}
    options = [
        "--html",
        outputs["html"],
        "--png",
        outputs["png"],
        "--mirror",
        outputs["ply"],
        "--save",
        outputs["json"],
    ]
    status, out, err = run("detect", scan, "--quiet", *options)
    assert (status, err) == (0, "")
    assert all(str(path) in out for path in outputs.values())
    points = read_points(scan).points
    completed = read_points(outputs["ply"]).points
    np.testing.assert_array_equal(completed[: len(points)], points)
    np.testing.assert_allclose(completed[len(points) :], points * [-1, 1, 1] + [0.5, 0, 0], atol=1e-15)
    assert symjax.load(outputs["json"]).score == 0.7
    assert outputs["png"].read_bytes().startswith(b"\x89PNG")
    assert outputs["html"].read_text(encoding="utf-8").lstrip().lower().startswith("<!doctype html>")

    for name, path in outputs.items():
        path.write_text("mine")
        option = {"ply": "--mirror", "json": "--save"}.get(name, f"--{name}")
        status, out, err = run("detect", scan, option, path)
        assert status == 2
        assert "use --force" in err
        assert path.read_text() == "mine"
        assert run("detect", scan, option, path, "--force")[0] == 0
        assert path.read_bytes() != b"mine"


def test_outputs_that_cannot_be_are_refused_before_the_work(run, scan, tmp_path, monkeypatch):
    monkeypatch.setattr(detect, "detect", None)
    for options, why in [
        (["--mirror", scan, "--force"], "it is the input or another output"),
        (["--png", tmp_path / "a", "--html", tmp_path / "a"], "it is the input or another output"),
        (["--png", tmp_path], "it is a folder"),
        (["--png", tmp_path / "no" / "a.png"], "there is no folder"),
        (["--mirror", tmp_path / "a.obj"], "end the name in .ply"),
    ]:
        status, out, err = run("detect", scan, *options)
        assert (status, out) == (2, "")
        assert why in err


def test_errors_are_one_line_and_status_2(run, scan, tmp_path, monkeypatch):
    def degenerate(points, **options):
        raise DegenerateCloudError("all points\ncoincide")

    monkeypatch.setattr(detect, "detect", degenerate)
    for arguments, why in [
        (["detect", scan], "all points coincide"),
        (["detect", tmp_path / "none.ply"], "No such file"),
        (["detect", tmp_path], "it is a folder"),
        (["detect", scan, "--samples", 0], "num_samples"),
        (["detect", scan, "--nonfinite", "keep"], "'keep' is not one of"),
        (["detect"], "Missing argument 'FILE'"),
        (["detect", scan, "--colour"], "No such option"),
        (["detect", scan, "--seed", -1], "--seed"),
        (["mirror"], "No such command"),
        (["demo", "--out", tmp_path / "none"], "there is no folder"),
    ]:
        status, out, err = run(*arguments)
        assert (status, out) == (2, "")
        assert err.startswith("symjax: error: ")
        assert err.count("\n") == 1
        assert why in err


def test_debug_shows_the_traceback(scan, monkeypatch):
    def degenerate(points, **options):
        raise DegenerateCloudError("all points coincide")

    monkeypatch.setattr(detect, "detect", degenerate)
    with pytest.raises(DegenerateCloudError, match="coincide"):
        cli.main(["detect", str(scan), "--debug"])


def test_warnings_are_one_line_each(run, scan, monkeypatch):
    def warns(points, **options):
        for _ in range(2):
            warnings.warn("the graph is in\n2 pieces", ComponentsWarning, stacklevel=1)
        return fake_detect(points, **options)

    monkeypatch.setattr(detect, "detect", warns)
    status, _, err = run("detect", scan)
    assert status == 0
    assert [line for line in err.splitlines() if "warning" in line] == ["symjax: warning: the graph is in 2 pieces"] * 2


def test_progress_names_the_stages_on_a_terminal_unless_quiet(run, fake, scan, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    _, out, err = run("detect", scan)
    assert all(stage in err for stage in ("reading", *STAGES))
    assert "preparing 0.50" in out
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    assert run("detect", scan, "--quiet")[2] == ""


def test_progress_is_a_plain_line_a_stage_where_stderr_is_no_terminal(run, fake, scan):
    assert run("detect", scan)[2].splitlines() == [f"symjax: {stage} ..." for stage in STAGES if stage not in CHECKING]
    assert run("detect", scan, "--quiet")[2] == ""


def test_compiled_programs_are_kept_only_if_asked(run, fake, scan, monkeypatch):
    kept = []
    monkeypatch.setattr("symjax.l2e.compilation_cache.enable_compilation_cache", lambda: kept.append(True))
    assert run("detect", scan)[0] == 0
    assert kept == []
    assert run("detect", scan, "--cache")[0] == 0
    assert kept == [True]


def test_a_cache_that_cannot_be_made_is_one_line(run, fake, scan, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("SYMJAX_CACHE", str(tmp_path / "file" / "cache"))
    status, out, err = run("detect", scan, "--cache")
    assert (status, out) == (2, "")
    assert err.startswith("symjax: error: cannot keep compiled programs (--cache)")
    assert err.count("\n") == 1


def test_no_arguments_show_the_help(run):
    status, out, err = run()
    assert (status, err) == (0, "")
    assert "Commands:" in out


def test_the_demo_finds_its_own_plane(run, tmp_path):
    status, out, err = run("demo", "--out", tmp_path, "--quiet")
    assert (status, err) == (0, "")
    error = next(line for line in out.splitlines() if line.startswith("error")).split()
    assert float(error[1]) < 5
    assert float(error[4].rstrip("%")) < 3
    for name in ("demo.html", "demo.png"):
        assert (tmp_path / name).stat().st_size > 1000
        assert str(tmp_path / name) in out
    status, out, err = run("demo", "--out", tmp_path)
    assert (status, out) == (2, "")
    assert "use --force" in err
