"""σ and the share of mirror pairs estimated with the plane, and whether the standard errors are honest."""

from collections.abc import Iterator
from dataclasses import dataclass

import jax
import numpy as np
from tqdm import trange

from experiments.data import PLANTED
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.datasets.planted_pairs import NOISE, planted_pairs
from symjax.geometry.directions import deviation_angle
from symjax.geometry.plane import Plane
from symjax.l2e.fit_global import fit_global
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.pairs.arguments import AUTO
from symjax.l2e.standard_errors import standard_errors


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_pairs: pairs of the estimates.
        seeds: sets of pairs at each share of outliers.
        trials: sets of pairs whose regions are counted.
        trial_pairs: pairs of those.
        trial_outliers: share of outliers among them.
        level: of the regions.
    """

    num_pairs: int = 4000
    seeds: int = 16
    trials: int = 2000
    trial_pairs: int = 500
    trial_outliers: float = 0.5
    level: float = 0.95


SIZES = {"full": Config(), "small": Config(num_pairs=400, seeds=2, trials=4, trial_pairs=200)}


def run(config: Config) -> list[Row]:
    """One row a figure."""
    with jax.enable_x64(True):
        return [*_estimates(config), *_coverage(config)]


def _row(figure: str, case: str, value: float, worst: float | str, target: str) -> Row:
    return {"figure": figure, "case": case, "value": value, "worst": worst, "target": target}


def _estimates(config: Config) -> Iterator[Row]:
    for share in (0.0, 0.3, 0.6, 0.8):
        scale, inliers, angles = [], [], []
        for seed in trange(config.seeds, desc=f"{share:.0%} outliers", leave=False, disable=None):
            pairs = planted_pairs(np.random.default_rng([seed, 11]), config.num_pairs, share)
            fit = fit_global(pairs.x, pairs.y, AUTO)
            scale.append(float(fit.sigma) / NOISE - 1)
            inliers.append(float(fit.inlier_fraction) - (1 - share))
            angles.append(float(deviation_angle(np.asarray(fit.plane.normal), pairs.normal)))
        case = f"{share:.0%} outliers"
        yield _row("sigma, relative error", case, float(np.median(scale)), _largest(scale), "within 0.05, worst 0.1")
        yield _row("inlier fraction, error", case, float(np.median(inliers)), _largest(inliers), "within 0.03")
        yield _row("plane, degrees", case, float(np.median(angles)), max(angles), "")


def _largest(errors: list[float]) -> float:
    return max(errors, key=abs)


def _coverage(config: Config) -> Iterator[Row]:
    """How often the region of every fit holds the planted plane; the fits start there, as none may miss it."""
    for sigma in (2 * NOISE, AUTO):
        held, turns, shifts = [], [], []
        for seed in trange(config.trials, desc=f"sigma {sigma}", leave=False, disable=None):
            pairs = planted_pairs(np.random.default_rng([seed, 13]), config.trial_pairs, config.trial_outliers)
            fit = fit_plane(pairs.x, pairs.y, sigma, pairs.normal)
            region = standard_errors(fit, pairs.x, pairs.y).plane
            estimate = Plane(np.asarray(fit.plane.normal), np.asarray(fit.plane.offset))
            truth = Plane(pairs.normal, np.asarray(pairs.offset))
            held.append(region.contains(estimate, truth, level=config.level))
            turns.append(float(estimate.angle(truth)) / region.normal_degrees)
            side = np.sign(pairs.normal @ estimate.normal)
            apart = side * (truth.offset - truth.normal @ region.centre)
            shifts.append((estimate.offset - estimate.normal @ region.centre - apart) / region.offset)
        case = f"sigma {sigma}, {config.trial_pairs} pairs, {config.trial_outliers:.0%} outliers"
        holding = f"regions that hold the plane, {config.trials} trials"
        yield _row(holding, case, float(np.mean(held)), "", "0.93 to 0.97")
        for error, values in (("turn", turns), ("shift", shifts)):
            figure = f"{error} over its standard error, root mean square"
            yield _row(figure, case, float(np.sqrt(np.mean(np.square(values)))), "", "1")


STUDY = Study("self_scale", __doc__, SIZES, run, data=PLANTED)
