"""How often the planted plane is found by `fit_global` and by other starts and solvers, with two kinds of outliers.

Outliers are random or structured. With structured outliers, half of the outlier pairs follow a second plane, with ten
times the noise of the mirror pairs. At a large σ the second plane has the lower loss; at a σ near the noise the planted
plane has.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, PRNGKeyArray
from tqdm import tqdm

from experiments.data import PLANTED
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.datasets.planted_pairs import PlantedPairs, planted_pairs
from symjax.geometry.directions import deviation_angle
from symjax.l2e.fit import Fit, best
from symjax.l2e.fit_global import fit_global
from symjax.l2e.manifolds import random_points
from symjax.l2e.solvers.names import SOLVER_NAMES
from symjax.l2e.starts.names import STARTS
from symjax.l2e.sweep import sweep

SUCCESS = 5.0
"""Largest angle to the planted plane, in degrees, at which it counts as found."""

SECOND_NOISE = 0.1
"""Noise of the pairs that follow the second plane; that of the mirror pairs is 0.01."""

PASSES_TOL = 1e-8
"""Bound on the gradient up to which passes are counted."""

LOCAL_ANGLE = 0.15
"""Largest angle of local starts to the planted plane, in radians."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        sizes: numbers of pairs, separated by commas.
        seeds: sets of pairs for each case.
        restarts: number of starts, except for `fit_global`.
        sigma: scale σ of `fit_global`; the noise of the pairs is 0.01.
        scales: scales σ of the comparison of starts and solvers, separated by commas.
    """

    sizes: str = "1000,10000"
    seeds: int = 16
    restarts: int = 64
    sigma: float = 0.015
    scales: str = "0.02,0.05,0.2"


SIZES = {"full": Config(), "small": Config(sizes="300", seeds=2, restarts=8, scales="0.05")}


def structured(seed: int, num_pairs: int, outliers: float) -> PlantedPairs:
    """Plants pairs, and lets half of the outliers follow a second plane through the object."""
    rng = np.random.default_rng([seed, 7])
    pairs = planted_pairs(rng, num_pairs, outliers)
    second = round(outliers * num_pairs) // 2
    centre = pairs.x.mean(axis=0)
    # perpendicular to the planted plane, and slightly off the centre
    normal = np.cross(pairs.normal, rng.normal(size=3))
    normal /= np.linalg.norm(normal)
    height = (pairs.x[:second] - centre) @ normal - 0.1
    pairs.y[:second] = pairs.x[:second] - 2 * np.outer(height, normal) + SECOND_NOISE * rng.normal(size=(second, 3))
    return pairs


def run(config: Config) -> list[Row]:
    """Returns one row per question and case."""
    with jax.enable_x64(True):
        return [*_global(config), *_starts(config), *_passes(config)]


def _row(question: str, case: str, single: float | str, overall: float | str, steps: float, target: str) -> Row:
    return {
        "question": question,
        "case": case,
        "success of one start": single,
        "success of the best": overall,
        "steps": steps,
        "target": target,
    }


def _angle(fit: Fit, pairs: PlantedPairs) -> Float[np.ndarray, "..."]:
    return np.asarray(deviation_angle(np.asarray(fit.plane.normal), pairs.normal))


def _global(config: Config) -> Iterator[Row]:
    for size in map(int, config.sizes.split(",")):
        for share in (0.0, 0.5, 0.8, 0.9, 0.95):
            sets = [planted_pairs(np.random.default_rng([seed, size]), size, share) for seed in range(config.seeds)]
            yield _global_row("fit_global, random outliers", size, share, sets, config.sigma)
        sets = [structured(seed, size, 0.9) for seed in range(config.seeds)]
        yield _global_row("fit_global, structured outliers", size, 0.9, sets, config.sigma)


def _global_row(question: str, size: int, share: float, sets: list[PlantedPairs], sigma: float) -> Row:
    hits, steps = [], []
    for pairs in tqdm(sets, desc=f"{size} pairs, {share:.0%}", leave=False, disable=None):
        fit = fit_global(pairs.x, pairs.y, sigma)
        hits.append(_angle(fit, pairs) < SUCCESS)
        steps.append(float(fit.num_steps))
    return _row(
        question,
        f"{size} pairs, {share:.0%} outliers",
        "",
        float(np.mean(hits)),
        float(np.mean(steps)),
        "success of the best 1",
    )


def _starts(config: Config) -> Iterator[Row]:
    """Success of all kinds of start and all solvers at 80 % outliers: of one start, and of the best of all starts."""
    size = int(config.sizes.split(",")[0])
    kinds = {"random outliers": [planted_pairs(np.random.default_rng([s, 3]), size, 0.8) for s in range(config.seeds)]}
    kinds["structured outliers"] = [structured(seed, size, 0.8) for seed in range(config.seeds)]
    sigmas = [float(sigma) for sigma in config.scales.split(",")]
    combinations = [(start, "newton") for start in STARTS] + [
        ("fibonacci", solver) for solver in SOLVER_NAMES if solver != "newton"
    ]
    for kind, sets in kinds.items():
        for start, solver in tqdm(combinations, desc=kind, leave=False, disable=None):
            key = jax.random.key(0) if start == "random" else None
            fits = [
                sweep(p.x, p.y, sigmas, start, restarts=config.restarts, solver=solver, max_steps=500, key=key)
                for p in sets
            ]
            single = np.stack([_angle(fit, p) < SUCCESS for fit, p in zip(fits, sets, strict=True)])
            overall = np.stack([_angle(best(fit), p) < SUCCESS for fit, p in zip(fits, sets, strict=True)])
            steps = np.stack([fit.num_steps for fit in fits])
            for k, sigma in enumerate(sigmas):
                rates = float(single[:, k].mean()), float(overall[:, k].mean()), float(steps[:, k].mean())
                yield _row(f"80 %, {kind}, sigma {sigma:g}", f"{start}, {solver}", *rates, "")


def _near(v: Float[Array, " 3"], directions: Float[Array, "r 3"], key: PRNGKeyArray) -> Float[Array, "r 3"]:
    """Normals rotated from v towards the directions, by angles up to `LOCAL_ANGLE`."""
    tangents = directions - jnp.sum(directions * v[None, :], axis=1, keepdims=True) * v[None, :]
    tangents = tangents / jnp.linalg.norm(tangents, axis=1, keepdims=True)
    angles = LOCAL_ANGLE * jax.random.uniform(key, (len(directions), 1))
    normals: Float[Array, "r 3"] = jnp.cos(angles) * v[None, :] + jnp.sin(angles) * tangents
    return normals


def _passes(config: Config) -> Iterator[Row]:
    """Passes over the pairs that Newton's method takes to reach a gradient of 1e-8."""
    size = int(config.sizes.split(",")[0])
    for sigma in (0.02, 0.05, 0.2):
        for kind, share in (("local", 0.5), ("random", 0.8)):
            counts, hits = [], []
            for seed in range(config.seeds):
                pairs = planted_pairs(np.random.default_rng([seed, 5]), size, share)
                starts = random_points(jax.random.key(seed), config.restarts)
                if kind == "local":
                    starts = _near(jnp.asarray(pairs.normal), starts, jax.random.key(seed + 99))
                fit = sweep(pairs.x, pairs.y, [sigma], starts, tol=PASSES_TOL)
                counts.append(np.asarray(fit.num_steps) + 1)
                hits.append(_angle(fit, pairs) < SUCCESS)
            passes = float(np.median(counts) if kind == "local" else np.mean(counts))
            name = f"{'median' if kind == 'local' else 'mean'} of passes, sigma {sigma:g}"
            target = "<= 6 passes" if kind == "local" else "<= 15 passes"
            yield _row(f"{kind} starts, {share:.0%} outliers", name, float(np.mean(hits)), "", passes, target)


STUDY = Study("success", __doc__, SIZES, run, data=PLANTED)
