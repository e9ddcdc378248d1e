"""How far off a start may be: error against the angle between the normal of the start and the true one.

The paper states that 3DSymm, which alternates between nearest neighbours and least squares, fails if its start is more
than about 20 degrees off. Each start here is the true plane, rotated about the centre of the object, so that only its
angle is wrong. 3DSymm runs from these starts, and so does L2E on fixed pairs (those of Sym-HKS, and planted pairs).
`symjax.detect` receives the same plane as `init` in addition to its own starts, so its error should hardly depend on
the angle. 3DSymm from 26 starts of its own does not use the given start at all. The objects are generated, in random
poses, whole or with a part missing; the paper's are partial scans, without a curve.
"""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path

import jax
import numpy as np
from jaxtyping import Float
from tqdm import tqdm

import symjax
from experiments.baselines.frame import make_frame
from experiments.baselines.three_d_symm import ThreeDSymm, alternate, nearest
from experiments.data import GENERATED_SINGLE, corruptions
from experiments.data.cases import generated_cases, kinds_of
from experiments.data.corruptions import Trial
from experiments.framework import figures
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import WITHIN_ANGLE, deviation
from symjax import Robust
from symjax.datasets.planted_pairs import SEMI_AXES, planted_pairs
from symjax.errors import SymjaxWarning
from symjax.geometry.plane import Plane

PAPER_ANGLE = 20.0

REQUIRED_SHARE = 0.9
"""Share of results within `WITHIN_ANGLE` degrees that is required up to the tolerated angle of the start."""

SIGMA = 0.05
"""Scale σ for planted pairs, in radii of the object; the noise of the pairs is 0.01."""

Solve = Callable[[Plane], Plane]
"""Runs a method from a start and returns the plane that it reaches."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        angles: angles between the start and the true plane in degrees, separated by commas.
        num_points: points of a cloud before the corruption.
        seeds: clouds of each kind, and sets of planted pairs of each blob.
        kinds: number of kinds with a single mirror plane, from the first.
        conditions: names of the conditions, separated by commas.
        num_pairs: number of planted pairs.
        outliers: shares of outliers among the planted pairs, separated by commas.
    """

    angles: str = "0,5,10,15,20,25,30,40,50,60,70,80,90"
    num_points: int = 5000
    seeds: int = 3
    kinds: int = 8
    conditions: str = "clean,miss28"
    num_pairs: int = 1000
    outliers: str = "0,0.65"


SIZES = {"full": Config(), "small": Config(angles="0,20,30,60,90", num_points=1500, seeds=1, kinds=3)}


def rotated(plane: Plane, centre: Float[np.ndarray, " 3"], degrees: float, rng: np.random.Generator) -> Plane:
    """Rotates a plane about a random line in it that passes through the projection of a point onto the plane."""
    foot = centre - (centre @ plane.normal - plane.offset) * plane.normal
    tangent = np.cross(plane.normal, rng.normal(size=3))
    tangent /= np.linalg.norm(tangent)
    normal = np.cos(np.radians(degrees)) * plane.normal + np.sin(np.radians(degrees)) * tangent
    return Plane(normal, np.asarray(normal @ foot))


def run(config: Config) -> list[Row]:
    """Returns one row per method and start."""
    with jax.enable_x64(True), warnings.catch_warnings():
        warnings.simplefilter("ignore", SymjaxWarning)
        return [*_on_clouds(config), *_on_planted_pairs(config)]


def _angles(config: Config) -> list[float]:
    return [float(angle) for angle in config.angles.split(",")]


def _on_clouds(config: Config) -> Iterator[Row]:
    cases = list(generated_cases(config.num_points, config.seeds, kinds_of("single", config.kinds)))
    names = split_names(config.conditions, corruptions.CONDITIONS)
    for trial in tqdm(corruptions.trials(cases, names), total=len(cases) * len(names), disable=None):
        (truth,), centre = trial.case.planes, trial.case.points.mean(axis=0)
        about = {"condition": trial.condition, "model": trial.case.name, "seed": trial.case.seed}
        for method, solve in _methods(trial).items():
            rng = np.random.default_rng([trial.case.seed, *trial.case.name.encode()])
            for degrees in _angles(config):
                error = deviation(solve(rotated(truth, centre, degrees, rng)), trial.case)
                yield about | _row(method, degrees, error.angle)


def _methods(trial: Trial) -> dict[str, Solve]:
    detection = symjax.detect(trial.points, "sym-hks", rng=0)
    if detection.sigma is None:
        raise ValueError("the detection of Sym-HKS has no scale σ, which L2E needs")
    pairs, sigma = detection.pairs, detection.sigma * detection.diagonal
    from_own_starts = ThreeDSymm(starts="half-sphere").rank(trial.points, np.random.default_rng(0)).plane()
    return {
        "3DSymm": _three_d_symm(trial.points),
        "3DSymm, 26 starts": lambda _: from_own_starts,
        "L2E, pairs of Sym-HKS": partial(_l2e, pairs.x, pairs.y, sigma),
        "symjax, own starts and init": lambda start: symjax.detect(trial.points, Robust(init=start), rng=0).plane,
    }


def _three_d_symm(points: Float[np.ndarray, "n 3"]) -> Solve:
    """3DSymm's alternation from one start, on all points."""
    frame = make_frame(points, np.random.default_rng(0), max_points=len(points))
    match = nearest(frame.points)

    def solve(start: Plane) -> Plane:
        local = frame.to_given.inverse().plane(start)
        normal, offset = alternate(frame.points, np.asarray(local.normal), float(local.offset), match)
        return frame.ranking(normal[None], np.array([offset]), np.zeros(1)).plane()

    return solve


def _l2e(x: Float[np.ndarray, "n 3"], y: Float[np.ndarray, "n 3"], sigma: float, start: Plane) -> Plane:
    """L2E from the normal of a start; the fit searches for the offset itself."""
    plane = symjax.fit_plane(x, y, sigma, start.normal).plane
    return Plane(np.asarray(plane.normal), np.asarray(plane.offset))


def _on_planted_pairs(config: Config) -> Iterator[Row]:
    for share, blob, seed in product(map(float, config.outliers.split(",")), SEMI_AXES, range(config.seeds)):
        rng = np.random.default_rng([seed, *blob.encode()])
        pairs = planted_pairs(rng, config.num_pairs, share, blob)
        truth = Plane(pairs.normal, np.asarray(pairs.offset))
        centre = (pairs.x.mean(axis=0) + pairs.y.mean(axis=0)) / 2
        about = {"condition": f"{share:.0%} outlier pairs", "model": blob, "seed": seed}
        for degrees in _angles(config):
            angle = float(_l2e(pairs.x, pairs.y, SIGMA, rotated(truth, centre, degrees, rng)).angle(truth))
            yield about | _row("L2E, planted pairs", degrees, angle)


def _row(method: str, start: float, angle: float) -> Row:
    return {"method": method, "start": start, "angle": angle, "within": angle < WITHIN_ANGLE}


def curves(rows: list[Row]) -> dict[tuple[str, str], dict[float, list[Row]]]:
    """Groups the rows of each condition and method by the angle of the start."""
    return {key: grouped(group, "start") for key, group in grouped(rows, "condition", "method").items()}


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates the share within 5 degrees at each angle of the start, and the largest angle up to which it is 90 %."""
    lines = []
    for (condition, method), curve in curves(rows).items():
        shares = {angle: float(np.mean([row["within"] for row in group])) for angle, group in curve.items()}
        tolerated = [
            angle for angle in shares if all(shares[less] >= REQUIRED_SHARE for less in shares if less <= angle)
        ]
        line: Row = {"condition": condition, "method": method, "clouds": len(next(iter(curve.values())))}
        line |= {f"{angle:g} deg": share for angle, share in shares.items()}
        paper = f"fails beyond about {PAPER_ANGLE:g} deg" if method == "3DSymm" else ""
        lines.append(line | {"90 % up to, deg": max(tolerated, default="-"), "paper": paper, "data": "generated"})
    return lines


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws the share within 5 degrees and the median error over the angle of the start, one column per condition."""
    names, methods = (list(dict.fromkeys(row[key] for row in rows)) for key in ("condition", "method"))
    figure = figures.new(3.2 * len(names), 6)
    panels = figure.subplots(2, len(names), sharex=True, sharey="row", squeeze=False)
    for (condition, method), curve in curves(rows).items():
        upper, lower = panels[:, names.index(condition)]
        line = {"color": f"C{methods.index(method)}", "marker": ".", "label": method}
        upper.plot(list(curve), [np.mean([row["within"] for row in group]) for group in curve.values()], **line)
        lower.plot(list(curve), [np.median([row["angle"] for row in group]) for group in curve.values()], **line)
        upper.set_title(condition, fontsize=10)
        lower.set(xlabel="angle of the start, degrees", yscale="log")
    for panel in panels.flat:
        panel.axvline(PAPER_ANGLE, color="black", linestyle=":", linewidth=1)
        panel.grid(alpha=0.3)
    panels[0, 0].set_ylabel(f"share within {WITHIN_ANGLE:g} degrees")
    panels[1, 0].set_ylabel("median error, degrees")
    lines = {line.get_label(): line for panel in panels[0] for line in panel.get_lines()[:-1]}
    figure.legend(handles=list(lines.values()), loc="outside lower center", ncols=3, fontsize=8)
    figure.suptitle("dotted: angle beyond which 3DSymm fails according to the paper, on other data", fontsize=9)
    figures.save(figure, path)


STUDY = Study(
    "start_angle",
    __doc__,
    SIZES,
    run,
    summary,
    draw=draw,
    data=GENERATED_SINGLE,
    paper="its claim that alternating L2 fails if the start is more than 20° off",
)
