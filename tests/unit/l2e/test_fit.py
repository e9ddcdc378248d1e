import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError, InvalidPointsError, NonfiniteError, TooFewPointsError
from symjax.geometry.directions import deviation_angle, fibonacci
from symjax.l2e import fit_plane as fit_plane_module
from symjax.l2e import sweep as sweep_module
from symjax.l2e.fit import SIGMA_TOO_LARGE, Fit, best
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.objective import l2e_loss
from symjax.l2e.status import Status
from symjax.l2e.sweep import sweep

SIGMA = 0.05
NUM = 60  # one size in most tests: one compilation

jitted = jax.jit(fit_plane)


def planted(seed=0, outliers=0.5, blob="thin", num=NUM, **options):
    return planted_pairs(np.random.default_rng(seed), num, outliers, blob, **options)


@pytest.fixture(scope="module")
def pairs():
    return planted()


@pytest.fixture(scope="module")
def grid(pairs):
    return sweep(pairs.x, pairs.y, [0.03, 0.05, 0.1], fibonacci(20))


@pytest.mark.parametrize("blob", ["isotropic", "thin", "wide"])
@pytest.mark.parametrize(("scale", "shift"), [(1.0, 1.0), (1.0, 1e4), (1e-12, 1.0), (1e12, 1e3)])
def test_exact_pairs_give_the_exact_plane_in_any_unit_and_place(blob, scale, shift):
    p = planted(1, 0.0, blob, noise=0.0, shift=shift)
    x, y = scale * p.x, scale * p.y
    v0 = p.normal + [0.1, -0.05, 0.1]
    fit = fit_plane(x, y, SIGMA * scale, v0 / np.linalg.norm(v0))
    assert fit.converged
    # at 1e4 times the size from the origin, coordinates are themselves rounded to 1e-12 of the size
    assert deviation_angle(fit.plane.normal, p.normal) <= 1e-6
    foot = p.offset * p.normal * scale + (p.x.mean(0) - (p.x.mean(0) @ p.normal) * p.normal) * scale
    diagonal = np.linalg.norm(np.ptp(x, axis=0))
    assert abs(fit.plane.signed_distance(foot[None])[0]) <= 1e-9 * diagonal


@pytest.mark.any_precision
def test_float32_stays_float32_and_is_right():
    p = planted(1, 0.0, noise=0.0)
    x, y = np.asarray(p.x, np.float32), np.asarray(p.y, np.float32)
    fit = fit_plane(x, y, SIGMA)
    assert fit.plane.normal.dtype == fit.plane.offset.dtype == fit.loss.dtype == jnp.float32
    assert fit.converged
    assert deviation_angle(np.asarray(fit.plane.normal, float), p.normal) <= 0.01


@pytest.mark.any_precision
def test_outliers_do_not_move_the_plane():
    fits = jax.jit(jax.vmap(lambda x, y: fit_plane(x, y, SIGMA)))
    trials = [planted(seed, 0.65, num=300) for seed in range(20)]
    found = fits(jnp.stack([jnp.asarray(p.x) for p in trials]), jnp.stack([jnp.asarray(p.y) for p in trials]))
    angles = deviation_angle(found.plane.normal, np.stack([p.normal for p in trials]))
    assert (np.asarray(angles) < 7).all()
    assert found.converged.all()


@pytest.mark.parametrize("blob", ["isotropic", "thin", "wide"])
def test_restarts_find_the_plane_among_eighty_per_cent_outliers(blob):
    for seed in range(5):
        p = planted(seed, 0.8, blob, num=300)
        found = best(sweep(p.x, p.y, [SIGMA], fibonacci(64)))
        assert found.converged.all()
        assert deviation_angle(found.plane.normal[0], p.normal) < 7


def test_loss_is_the_loss_of_the_plane(pairs):
    fit = fit_plane(pairs.x, pairs.y, SIGMA)
    expected = l2e_loss(*fit.plane, SIGMA, jnp.asarray(pairs.x), jnp.asarray(pairs.y))
    np.testing.assert_allclose(fit.loss, expected, rtol=1e-12)


def test_swapped_pairs_and_an_opposite_start_give_the_same_plane(pairs):
    v0 = np.array([0.6, 0.0, 0.8])
    expected = fit_plane(pairs.x, pairs.y, SIGMA, v0).plane
    for plane in (fit_plane(pairs.y, pairs.x, SIGMA, v0).plane, fit_plane(pairs.x, pairs.y, SIGMA, -v0).plane):
        np.testing.assert_allclose(plane.normal, expected.normal, atol=1e-9)
        np.testing.assert_allclose(plane.offset, expected.offset, atol=1e-9)


def test_weight_zero_is_absence(pairs):
    keep = np.arange(NUM) % 3 > 0
    junk = np.where(keep[:, None], pairs.x, 1e3), np.where(keep[:, None], pairs.y, -1e3)
    fit, same = (fit_plane(x, y, SIGMA, weights=keep) for x, y in ((pairs.x, pairs.y), junk))
    np.testing.assert_allclose(same.plane.normal, fit.plane.normal, atol=1e-12)
    loss = l2e_loss(*fit.plane, SIGMA, jnp.asarray(pairs.x[keep]), jnp.asarray(pairs.y[keep]))
    np.testing.assert_allclose([fit.loss, same.loss], loss, rtol=1e-9)


@pytest.mark.parametrize(
    "options",
    [{"solver": "irls"}, {"solver": "rbfgs"}, {"solver": "alternating"}],
)
def test_every_solver_finds_the_same_plane(pairs, options):
    expected, other = (fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal, **o) for o in ({}, options))
    assert expected.converged
    assert other.converged
    np.testing.assert_allclose(other.plane.normal, expected.plane.normal, atol=1e-6)


def test_sweep_is_fit_plane_for_every_sigma_and_start(pairs, grid):
    v0s = fibonacci(20)
    assert grid.plane.normal.shape == (3, 20, 3)
    assert grid.loss.shape == grid.converged.shape == grid.num_steps.shape == (3, 20)
    for s, sigma in enumerate([0.03, 0.05, 0.1]):
        for r in (0, 7, 19):
            alone = fit_plane(pairs.x, pairs.y, sigma, v0s[r])
            np.testing.assert_allclose(grid.plane.normal[s, r], alone.plane.normal, atol=1e-8)
            np.testing.assert_allclose(grid.loss[s, r], alone.loss, rtol=1e-9)


def test_best_is_the_lowest_loss_that_converged(pairs, grid):
    found = best(grid)
    assert found.plane.normal.shape == (3, 3)
    loss = np.where(grid.converged, grid.loss, np.inf)
    np.testing.assert_array_equal(found.loss, loss.min(axis=1))
    assert found.converged.all()
    # fits that did not converge are ignored; if none converged, the lowest loss is returned with its own status
    short = sweep(pairs.x, pairs.y, [0.03, 0.05, 0.1], fibonacci(20), max_steps=0)
    mixed = jax.tree.map(lambda a, b: jnp.concatenate([a, b], axis=1), short, grid)
    np.testing.assert_array_equal(best(mixed).num_steps, found.num_steps)
    assert not best(short).converged.any()
    np.testing.assert_array_equal(best(short).loss, np.min(short.loss, axis=1))
    assert "max_steps" in best(short).message[0]


def test_a_sweep_and_its_repetition_compile_once(monkeypatch):
    p = planted(3, num=37)
    traces = []
    original = sweep_module._starts
    monkeypatch.setattr(sweep_module, "_starts", lambda *a, **k: traces.append(1) or original(*a, **k))
    first = sweep(p.x, p.y, [SIGMA], fibonacci(37))
    assert sum(traces) == 1
    again = sweep(p.x + 1, p.y + 1, [2 * SIGMA], -fibonacci(37), max_steps=77, tol=1e-9)
    assert sum(traces) == 1
    assert first.loss.shape == again.loss.shape == (1, 37)


def test_jit_of_the_caller_changes_nothing(pairs):
    expected = fit_plane(pairs.x, pairs.y, SIGMA)
    inside = jitted(jnp.asarray(pairs.x), jnp.asarray(pairs.y), SIGMA)
    for a, b in zip(jax.tree.leaves(inside), jax.tree.leaves(expected), strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)


def flat_problem():
    """Exact pairs and a start perpendicular to their plane: a saddle where every weight is zero."""
    rng = np.random.default_rng(0)
    x = rng.normal(size=(NUM, 3)) * [0.0, 1.0, 0.0] + [0.0, 0.0, 1.0]
    x[:, 0] = np.linspace(-1, 1, NUM)  # spaced so far that at this sigma no two pairs interact
    return x, x * [1.0, 1.0, -1.0], np.array([1.0, 0.0, 0.0])


@pytest.mark.any_precision
def test_a_plateau_is_flat_and_never_success():
    x, y, v0 = flat_problem()
    fit = fit_plane(x, y, 0.005, v0)
    assert not fit.converged
    assert "underflows to exactly zero" in fit.message
    swept = best(sweep(x, y, [0.005, 0.004, 0.003], np.tile(v0, (20, 1))))
    assert swept.message.tolist() == 3 * [fit.message]


def test_a_sigma_above_the_scale_of_the_residual_is_noted_and_the_fraction_clipped(pairs):
    fits = sweep(pairs.x, pairs.y, [0.01, 0.05], pairs.normal[None])
    assert fits.inlier_fraction.max() == 1
    assert fits.inlier_fraction[0, 0] < 1
    assert fits.converged.all()
    assert SIGMA_TOO_LARGE not in fits.message[0, 0]
    assert fits.message[1, 0] == f"{Status.SUCCESSFUL.sentence} {SIGMA_TOO_LARGE}"


def test_a_fit_keeps_its_start(pairs, grid):
    begun = sweep(pairs.x, pairs.y, [0.03, 0.05, 0.1], fibonacci(20), max_steps=0)
    for fits in (begun, grid):
        np.testing.assert_allclose(fits.start.normal, begun.plane.normal, atol=1e-12)
        np.testing.assert_allclose(fits.start.offset, begun.plane.offset, atol=1e-12)
    alone = fit_plane(pairs.x, pairs.y, 0.05, fibonacci(20)[7])
    np.testing.assert_allclose(alone.start.normal, grid.start.normal[1, 7], atol=1e-12)
    chosen = best(grid)
    row = np.argmin(np.where(grid.converged, grid.loss, np.inf), axis=1)
    np.testing.assert_array_equal(chosen.start.normal, grid.start.normal[np.arange(3), row])


def test_reaching_max_steps_is_reported(pairs):
    fit = fit_plane(pairs.x, pairs.y, SIGMA, np.array([0.6, 0.0, 0.8]), max_steps=2)
    assert not fit.converged
    assert "max_steps was reached" in fit.message
    assert fit.num_steps == 2


def test_nan_under_a_trace_is_a_status_and_before_it_an_error(pairs):
    x = pairs.x.copy()
    x[5, 1] = np.nan
    with pytest.raises(NonfiniteError, match=r"1 of 60 rows, the first is row 5"):
        fit_plane(x, pairs.y, SIGMA)
    traced = jitted(jnp.asarray(x), jnp.asarray(pairs.y), SIGMA)
    assert not traced.converged
    assert "NaN" in traced.message


GOOD = {"x": np.eye(3), "y": np.eye(3)[::-1], "sigma": 0.1}


@pytest.mark.parametrize(
    ("change", "error", "match"),
    [
        ({"x": np.ones((3, 5))}, InvalidPointsError, "transpose"),
        ({"x": np.ones((3, 2))}, InvalidPointsError, r"\(3, 2\)"),
        ({"x": np.ones((4, 3))}, InvalidPointsError, "mirror image"),
        ({"x": [[1, 2, 3], [1]]}, InvalidPointsError, "ragged"),
        ({"x": np.eye(3) * 1j}, InvalidPointsError, "complex"),
        ({"x": np.eye(3).astype(str)}, InvalidPointsError, "real numbers"),
        ({"x": np.eye(3) > 0}, InvalidPointsError, "bool"),
        ({"x": np.eye(3)[:2], "y": np.eye(3)[:2]}, TooFewPointsError, "2 pairs"),
        ({"y": np.full((3, 3), np.inf)}, NonfiniteError, "y has NaN or infinite"),
        ({"sigma": 0.0}, InvalidArgumentError, "sigma must be positive"),
        ({"sigma": -1.0}, InvalidArgumentError, "sigma must be positive"),
        ({"sigma": math.nan}, InvalidArgumentError, "sigma must be positive"),
        ({"sigma": [0.1, 0.2]}, InvalidArgumentError, "shape"),
        ({"v0": np.zeros(3)}, InvalidArgumentError, "unit length"),
        ({"v0": np.array([0.0, 0.0, 1.01])}, InvalidArgumentError, "unit length"),
        ({"v0": np.array([0.0, math.nan, 1.0])}, InvalidArgumentError, "unit length"),
        ({"v0": np.ones(2)}, InvalidArgumentError, "shape"),
        ({"weights": np.ones(2)}, InvalidArgumentError, "one weight for each pair"),
        ({"weights": np.array([1, -1, 1])}, InvalidArgumentError, r"weights\[1\]"),
        ({"weights": np.zeros(3)}, InvalidArgumentError, "every weight is zero"),
        ({"solver": "simplex"}, InvalidArgumentError, "'simplex' is unknown"),
        ({"solver": "joint"}, InvalidArgumentError, "'joint' is now called 'rbfgs'"),
        ({"solver": "mm"}, InvalidArgumentError, "'mm' is now called 'irls'"),
        ({"max_steps": -1}, InvalidArgumentError, "max_steps"),
        ({"max_steps": "a"}, InvalidArgumentError, "max_steps"),
        ({"max_steps": 2.5}, InvalidArgumentError, "max_steps"),
        ({"tol": 0.0}, InvalidArgumentError, "tol"),
        ({"tol": "a"}, InvalidArgumentError, "tol"),
    ],
    ids=lambda value: "-".join(value) if isinstance(value, dict) else None,
)
def test_bad_arguments_are_refused_before_anything_is_computed(monkeypatch, change, error, match):
    monkeypatch.setattr(fit_plane_module, "_fit_plane", None)
    with pytest.raises(error, match=match):
        fit_plane(**{**GOOD, **change})


def test_bad_sweeps_are_refused():
    with pytest.raises(InvalidArgumentError, match=r"sigmas must have shape \(S,\), got \(\)"):
        sweep(GOOD["x"], GOOD["y"], 0.1, np.eye(3))
    with pytest.raises(InvalidArgumentError, match=r"v0s must have shape \(R, 3\), got \(3,\)"):
        sweep(GOOD["x"], GOOD["y"], [0.1], np.eye(3)[0])
    with pytest.raises(InvalidArgumentError, match="1 of 3 starting normals"):
        sweep(GOOD["x"], GOOD["y"], [0.1], np.diag([1.0, 2.0, 1.0]))
    with pytest.raises(InvalidArgumentError, match="restarts must be a whole number"):
        sweep(GOOD["x"], GOOD["y"], [0.1], restarts=2.5)
    with pytest.raises(InvalidArgumentError, match="continuation"):
        sweep(GOOD["x"], GOOD["y"], [0.1], continuation="yes")


def test_integers_and_lists_convert():
    fit = fit_plane([[1, 0, 2], [0, 1, 1], [2, 1, 3]], [[1, 0, -2], [0, 1, -1], [2, 1, -3]], 1, [0, 0.6, 0.8])
    assert isinstance(fit, Fit)
    np.testing.assert_allclose(fit.plane.normal, [0, 0, 1], atol=1e-9)
