"""`symjax demo`: the plane of a generated scan is detected."""

import numpy as np

from symjax.datasets.demo_scan import MISSING, NUM_POINTS, OUTLIERS, make_scan


def test_the_scan_depends_on_the_seed_and_is_upright_in_its_plane():
    scan, again, other = make_scan(1), make_scan(1), make_scan(2)
    np.testing.assert_array_equal(scan.points, again.points)
    assert not np.array_equal(scan.points[:10], other.points[:10])
    assert len(scan.points) == int(NUM_POINTS * (1 - MISSING) * (1 + OUTLIERS))
    # the up direction lies in the mirror plane
    assert abs(scan.up @ scan.truth.normal) < 1e-6 * np.linalg.norm(scan.up)


def test_the_demo_finds_its_own_plane(run, tmp_path):
    status, out, err = run("demo", "--out", tmp_path, "--quiet")
    assert (status, err) == (0, "")
    error = next(line for line in out.splitlines() if line.startswith("error")).split()
    assert float(error[2]) < 5
    assert float(error[5].rstrip("%")) < 3
    for name in ("demo.html", "demo.png"):
        assert (tmp_path / name).stat().st_size > 1000
        assert str(tmp_path / name) in out
    status, out, err = run("demo", "--out", tmp_path / "none")
    assert (status, out) == (2, "")
    assert "does not exist" in err
    status, out, err = run("demo", "--out", tmp_path)
    assert (status, out) == (2, "")
    assert "use --force" in err
