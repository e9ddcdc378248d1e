"""What every stage of the robust method is good for: the share of right answers without it, by condition.

The package has no switches: each stage is replaced from outside. Without a stage scores change, and the threshold with
which they are compared was made for all of them; so a second table has the planes that are right, whether found or not.
On 46 clouds of `both` and `view` the neutral rim, the viewpoint and the outlier rule earned their place; agreement of
normals and exactness did not on these two (one cloud of a condition is 0.04).
"""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import ModuleType
from typing import Any
from unittest import mock

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int
from tqdm import tqdm

from experiments.baselines.registry import ENTRIES, OURS
from experiments.comparison.attempt import attempt
from experiments.data import corruptions
from experiments.data.cases import generated, kinds_of
from experiments.data.corruptions import Trial
from experiments.data.descriptions import SINGLE
from experiments.framework.options import chosen
from experiments.framework.study import Study
from experiments.framework.tables import Row
from experiments.metrics.deviation import deviation
from symjax.geometry.plane import Plane
from symjax.preprocess import cloud
from symjax.robust import classification, hypotheses, method, registration, scoring, search, surface, voxel_grid
from symjax.robust.refinement import Polished
from symjax.robust.registration import Planes
from symjax.robust.scoring import Evidence
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import Lattice

SMALLEST = 1e-300
"""Divisor where the normals are at right angles to all digits."""

SHARES = {"right": "right answers", "right plane": "right planes"}


def _evidence_without_normals(
    plane: Plane, cloud: Surface, cells: Lattice, rows: Int[np.ndarray, "m"] | slice = slice(None)
) -> Evidence:
    """The evidence, the agreement of the normals divided out."""
    found = WHOLE_EVIDENCE(plane, cloud, cells, rows)
    normals = cloud.normals[rows]
    facing = normals - 2 * (normals @ plane.normal)[:, None] * plane.normal
    cosine = (facing * cloud.normals[found.partner]).sum(axis=1)
    return found._replace(share=np.minimum(found.share / np.maximum(cosine**2, SMALLEST), 1.0))


def _mirrored_without_normals(*arguments: Any) -> Any:
    found = WHOLE_MIRRORED(*arguments)
    return found._replace(cosine=jnp.ones_like(found.cosine))


def _unregistered(planes: Planes, *_: Any, **__: Any) -> Planes:
    return planes


def _unpolished(plane: Plane, *arguments: Any) -> Polished:
    """All that the polish gives but its plane."""
    return WHOLE_POLISH(plane, *arguments)._replace(plane=plane)


def _no_pairs(*_: Any) -> Plane:
    return Plane(np.empty((0, 3)), np.empty(0))


def _all_trusted(points: Float[np.ndarray, "n 3"], *_: Any) -> Float[np.ndarray, "n"]:
    return np.ones(len(points))


def _none_scattered(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, "n"]:
    return np.zeros(len(points), bool)


class _Weight:
    """The agreement of a plane by the lattice, in the place of its evidence."""

    def __init__(self, plane: Plane, cloud: Surface, cells: Lattice, rows: Int[np.ndarray, "m"]) -> None:
        planes = Plane(plane.normal[None], np.array([plane.offset]))
        probes = search._probes(cloud, rows, search.NUM_WEIGHED_POINTS)
        self.score = float(search._agreement(planes, search.ROUNDS[-1].weighed, probes, cells)[0])


WHOLE_EVIDENCE, WHOLE_MIRRORED, WHOLE_POLISH = scoring.evidence, registration._mirrored, method.polish

Patch = tuple[ModuleType, str, Any]

STAGES: dict[str, tuple[Patch, ...]] = {
    "nothing": (),
    "agreement of normals": (
        (registration, "_mirrored", _mirrored_without_normals),
        *((module, "evidence", _evidence_without_normals) for module in (method, search, classification)),
    ),
    "neutral rim": ((voxel_grid, "BEYOND_RIM", 1.0),),
    "viewpoint": ((method, "find_viewpoint", lambda *_: None),),
    "trust": ((surface, "_trust", _all_trusted),),
    "registration": ((search, "register", _unregistered),),
    "pair hypotheses": ((hypotheses, "paired", _no_pairs),),
    "outlier rule": ((cloud, "scattered", _none_scattered),),
    "polish": ((method, "polish", _unpolished),),
    "exact weighing": ((search, "evidence", _Weight),),
    "exactness": ((method, "exactness", lambda *_: 0.0),),
}
"""What takes the place of every stage."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_points: points of a cloud before it is corrupted.
        seeds: objects of every kind.
        kinds: most generated kinds with one plane, counted from the first.
        conditions: which conditions, separated by commas.
        stages: which stages are left out, separated by commas; "nothing" is the whole method.
    """

    num_points: int = 5000
    seeds: int = 1
    kinds: int = 1000
    conditions: str = "clean,miss28,miss40,both,view"
    stages: str = ",".join(STAGES)


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=4, conditions="both,view")}


def run(config: Config) -> list[Row]:
    """One row a cloud and stage."""
    cases = list(generated(config.num_points, config.seeds, kinds_of("single", config.kinds)))
    trials = list(corruptions.trials(cases, chosen(config.conditions, corruptions.CONDITIONS)))
    rows = []
    for stage in tqdm(chosen(config.stages, STAGES), disable=None):
        with without(stage):
            rows += [_row(stage, trial) for trial in trials]
    return rows


@contextmanager
def without(stage: str) -> Iterator[None]:
    """Leaves a stage out of the robust method."""
    patches = STAGES[stage]
    traced: list[Any] = []
    if any(module is registration for module, _, _ in patches):
        traced = [registration.agreement, registration.register]
    with ExitStack() as stack:
        for function in traced:
            stack.callback(function.clear_cache)  # when all is in its place again
        for module, name, replacement in patches:
            stack.enter_context(mock.patch.object(module, name, replacement))
        for function in traced:
            function.clear_cache()
        yield


def _row(stage: str, trial: Trial) -> Row:
    found, _, error = attempt(ENTRIES[OURS], trial.points)
    if found is None:
        raise RuntimeError(f"without {stage}: {error}")
    off = deviation(found.plane, trial.case)
    row = trial.about | {"without": stage, "found": found.found, "angle": off.angle, "offset_error": off.offset}
    return row | {"right": found.found and off.right, "right plane": off.right}


def summary(rows: list[Row]) -> list[Row]:
    """A line a stage: the shares of right answers, then of right planes, found or not."""
    return [
        _line(stage, of, [row for row in rows if row["without"] == stage])
        for of in SHARES
        for stage in dict.fromkeys(row["without"] for row in rows)
    ]


def _line(stage: str, of: str, rows: list[Row]) -> Row:
    line: Row = {"without": stage, "share of": SHARES[of]}
    for condition in dict.fromkeys(row["condition"] for row in rows):
        line[condition] = float(np.mean([row[of] for row in rows if row["condition"] == condition]))
    return line | {"all": float(np.mean([row[of] for row in rows])), "clouds": len(rows)}


STUDY = Study("ablation", __doc__, SIZES, run, summary, data=SINGLE)
