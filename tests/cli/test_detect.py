"""`symjax detect`: its printed result, files, progress and errors. The detection itself is a stand-in here."""

import json
import warnings

import numpy as np
import pytest

import symjax
from symjax.cli.main import main
from symjax.cli.progress import CHECKING
from symjax.detection import detect
from symjax.detection.result import Candidate, Detection, Pairs
from symjax.errors import ComponentsWarning, DegenerateCloudError
from symjax.geometry.plane import Plane
from symjax.io.points import read_points, write_points
from symjax.robust.method import Robust
from symjax.symhks.method import SymHKS

PLANE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.25))
STAGES = ("preparing", "fitting")


def fake_detect(points, method, *, rng, nonfinite, drop_outliers, remove_ground, max_planes, progress):
    """Returns a detection of the plane x = 0.25, whose notes are the arguments."""
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
        method=method.name,
        sigma=0.03,
        diagonal=2.0,
        seed=rng,
        num_points=len(points),
        used=np.arange(len(points)),
        cleaned=False,
        notes=(
            f"nonfinite {nonfinite}, drop_outliers {drop_outliers}, remove_ground {remove_ground}, "
            f"max_planes {max_planes}, {method}",
        ),
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


def test_text_has_the_plane_and_its_evidence(run, fake, scan):
    status, out, err = run("detect", scan, "--quiet")
    assert (status, err) == (0, "")
    lines = dict(line.split(None, 1) for line in out.splitlines())
    assert lines["normal"] == "+1.000000  +0.000000  +0.000000"
    assert lines["offset"].startswith("+0.25 ")
    assert lines["found"].startswith("yes")
    assert "score 0.700, above the threshold of 0.300" in lines["found"]
    assert lines["inliers"] == "66.7% of 3 pairs"
    assert "The gradient is zero" in lines["solver"]
    expected = "nonfinite raise, drop_outliers None, remove_ground False, max_planes 9"
    assert lines["note"] == f"{expected}, {Robust()}"
    assert "cloud of 60 points" in lines["file"]
    assert "preparing 0.50" in lines["seconds"]


def test_json_is_one_object_and_nothing_else(run, fake, scan):
    status, out, _ = run("detect", scan, "--json", "--seed", 7)
    values = json.loads(out)
    assert status == 0
    assert out.count("\n") == 1
    assert values["plane"] == {"normal": [1.0, 0.0, 0.0], "offset": 0.25}
    assert (values["seed"], values["sigma"]) == (7, 0.03)
    assert values["file"] == str(scan)
    assert values["reading"]["note"] == "cloud of 60 points"


def test_options_reach_detect(run, fake, scan):
    _, out, _ = run("detect", scan, "--nonfinite", "drop", "--remove-ground", "--max-planes", 3)
    assert "nonfinite drop, drop_outliers None, remove_ground True, max_planes 3" in out
    assert "drop_outliers True" in run("detect", scan, "--drop-outliers")[1]
    assert "drop_outliers False" in run("detect", scan, "--keep-outliers")[1]


def test_options_reach_the_method(run, fake, scan):
    init = Plane(np.array([0.6, 0.0, 0.8]), np.array(0.5))
    assert str(Robust(init=init)) in run("detect", scan, "--init", 0.6, 0, 0.8, 0.5)[1]
    _, out, _ = run("detect", scan, "--method", "sym-hks", "--restarts", 5, "--sigma", 0.05)
    assert str(SymHKS(restarts=5, sigma=0.05)) in out


def test_every_named_method_is_the_one_that_runs(run, fake, scan):
    for name in detect.METHODS:
        assert str(detect.method_of(name)) in run("detect", scan, "--method", name)[1]


def test_help_states_the_choices_and_defaults_of_detect(run):
    _, out, _ = run("detect", "--help")
    assert f"[{'|'.join(detect.METHODS)}]" in out
    assert f"[default: {SymHKS().restarts}]" in out
    assert f"[default: {SymHKS().sigma_spacings:g} keypoint spacings]" in " ".join(out.split())
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


def test_impossible_outputs_are_refused_before_anything_is_computed(run, scan, tmp_path, monkeypatch):
    monkeypatch.setattr(detect, "detect", None)
    for options, why in [
        (["--mirror", scan, "--force"], "it is also the input or another output"),
        (["--png", tmp_path / "a", "--html", tmp_path / "a"], "it is also the input or another output"),
        (["--png", tmp_path], "it is a folder"),
        (["--png", tmp_path / "no" / "a.png"], "does not exist"),
        (["--mirror", tmp_path / "a.obj"], "must end in .ply"),
    ]:
        status, out, err = run("detect", scan, *options)
        assert (status, out) == (2, "")
        assert why in err


def test_errors_are_one_line_and_status_2(run, scan, tmp_path, monkeypatch):
    def degenerate(points, method, **options):
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
        (["detect", scan, "--keep-outliers", "--drop-outliers"], "contradict each other"),
        (["detect", scan, "--sigma", 0.05], "--sigma is an option of method sym-hks, not of robust"),
        (["detect", scan, "--restarts", 5], "use --method sym-hks"),
        (["detect", scan, "--method", "sym-hks", "--init", 1, 0, 0, 0], "--init is an option of method robust"),
        (["detect", scan, "--method", "sym-hks", "--sigma", -1], "sigma must be a finite number, above 0"),
    ]:
        status, out, err = run(*arguments)
        assert (status, out) == (2, "")
        assert err.startswith("symjax: error: ")
        assert err.count("\n") == 1
        assert why in err


def test_debug_shows_the_traceback(scan, monkeypatch):
    def degenerate(points, method, **options):
        raise DegenerateCloudError("all points coincide")

    monkeypatch.setattr(detect, "detect", degenerate)
    with pytest.raises(DegenerateCloudError, match="coincide"):
        main(["detect", str(scan), "--debug"])


def test_warnings_are_one_line_each(run, scan, monkeypatch):
    def warns(points, method, **options):
        for _ in range(2):
            warnings.warn("the cloud has\n2 components", ComponentsWarning, stacklevel=1)
        return fake_detect(points, method, **options)

    monkeypatch.setattr(detect, "detect", warns)
    status, _, err = run("detect", scan)
    assert status == 0
    assert [line for line in err.splitlines() if "warning" in line] == [
        "symjax: warning: the cloud has 2 components"
    ] * 2


def test_progress_names_the_stages_on_a_terminal_unless_quiet(run, fake, scan, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    _, out, err = run("detect", scan)
    assert all(stage in err for stage in ("reading", *STAGES))
    assert "preparing 0.50" in out
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    assert run("detect", scan, "--quiet")[2] == ""


def test_progress_is_a_line_per_stage_if_stderr_is_not_a_terminal(run, fake, scan):
    assert run("detect", scan)[2].splitlines() == [f"symjax: {stage} ..." for stage in STAGES if stage not in CHECKING]
    assert run("detect", scan, "--quiet")[2] == ""


def test_compiled_programs_are_cached_only_on_request(run, fake, scan, monkeypatch):
    kept = []
    monkeypatch.setattr("symjax.l2e.jax_config.enable_compilation_cache", lambda: kept.append(True))
    assert run("detect", scan)[0] == 0
    assert kept == []
    assert run("detect", scan, "--cache")[0] == 0
    assert kept == [True]


def test_a_cache_folder_that_cannot_be_created_is_a_one_line_error(run, fake, scan, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("SYMJAX_CACHE", str(tmp_path / "file" / "cache"))
    status, out, err = run("detect", scan, "--cache")
    assert (status, out) == (2, "")
    assert err.startswith("symjax: error: cannot cache compiled programs (--cache)")
    assert err.count("\n") == 1
