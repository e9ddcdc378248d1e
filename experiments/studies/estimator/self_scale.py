"""Accuracy of σ and of the inlier fraction that are estimated with the plane, and coverage of the standard errors."""

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
    """Options of the study.

    Attributes:
        num_pairs: number of pairs in a set, for the accuracy.
        seeds: sets of pairs for each share of outliers, for the accuracy.
        trials: sets of pairs, for the coverage.
        trial_pairs: number of pairs in a set, for the coverage.
        trial_outliers: share of outliers, for the coverage.
        level: confidence level of the regions.
    """

    num_pairs: int = 4000
    seeds: int = 16
    trials: int = 2000
    trial_pairs: int = 500
    trial_outliers: float = 0.5
    level: float = 0.95


SIZES = {"full": Config(), "small": Config(num_pairs=400, seeds=2, trials=4, trial_pairs=200)}


def run(config: Config) -> list[Row]:
    """Returns one row per quantity and case."""
    with jax.enable_x64(True):
        return [*_estimates(config), *_coverage(config)]


def _row(quantity: str, case: str, value: float, worst: float | str, target: str) -> Row:
    return {"quantity": quantity, "case": case, "value": value, "worst": worst, "target": target}


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
    """How often the region of a fit contains the planted plane; the fits start there, so that all converge to it."""
    for sigma in (2 * NOISE, AUTO):
        contained, normal_errors, offset_errors = [], [], []
        for seed in trange(config.trials, desc=f"sigma {sigma}", leave=False, disable=None):
            pairs = planted_pairs(np.random.default_rng([seed, 13]), config.trial_pairs, config.trial_outliers)
            fit = fit_plane(pairs.x, pairs.y, sigma, pairs.normal)
            region = standard_errors(fit, pairs.x, pairs.y).plane
            estimate = Plane(np.asarray(fit.plane.normal), np.asarray(fit.plane.offset))
            truth = Plane(pairs.normal, np.asarray(pairs.offset))
            contained.append(region.contains(estimate, truth, level=config.level))
            normal_errors.append(float(estimate.angle(truth)) / region.normal_degrees)
            sign = np.sign(pairs.normal @ estimate.normal)
            true_offset = sign * (truth.offset - truth.normal @ region.centre)
            offset_errors.append((estimate.offset - estimate.normal @ region.centre - true_offset) / region.offset)
        case = f"sigma {sigma}, {config.trial_pairs} pairs, {config.trial_outliers:.0%} outliers"
        coverage = f"share of regions that contain the plane, {config.trials} trials"
        yield _row(coverage, case, float(np.mean(contained)), "", "0.93 to 0.97")
        for name, errors in (("normal", normal_errors), ("offset", offset_errors)):
            quantity = f"{name} error / standard error, root mean square"
            yield _row(quantity, case, float(np.sqrt(np.mean(np.square(errors)))), "", "1")


STUDY = Study("self_scale", __doc__, SIZES, run, data=PLANTED)
