"""All methods that take part in comparisons, by name: symjax's own, the paper's algorithm, and the baselines.

To add a method, add a line to `ENTRIES`, with `baseline_entry` for a baseline (`experiments.baselines.baseline` shows
how to write one). The key names the method in the option `--methods` of the studies and in the result files; the title
names it in the tables. A method that compiles code also belongs in `COMPILES_ONCE` or `COMPILES_PER_SIZE`, so that its
times exclude compilation.
"""

import importlib.util
import sys
import warnings
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

import symjax
from experiments.baselines.cicconet import Cicconet
from experiments.baselines.hruda import Hruda
from experiments.baselines.kazhdan import Kazhdan
from experiments.baselines.maximum_likelihood import MaximumLikelihood
from experiments.baselines.nagar_raman import NagarRaman
from experiments.baselines.pca import PCA
from experiments.baselines.pyclarcs_em import Pyclarcs
from experiments.baselines.ransac_matches import RansacOnMatches
from experiments.baselines.ransac_points import RansacOnPoints
from experiments.baselines.three_d_symm import ThreeDSymm
from symjax import Detection, Robust, SymHKS
from symjax.detection.detect import MAX_PLANES
from symjax.errors import SymjaxWarning
from symjax.method.protocol import Method
from symjax.preprocess.cloud import MAX_POINTS

OURS = "robust"
"""The default of `symjax.detect`."""

PYCLARCS = "pyclarcs"
"""The only method that an optional package implements."""

COMPILES_ONCE = ("kazhdan", "3dsymm-26", PYCLARCS)
"""Methods whose first call in a process compiles code for all later calls; the first call is not timed."""

COMPILES_PER_SIZE = (OURS, "sym-hks-printed", "sym-hks", "sym-hks-cleaned")
"""Methods that may compile again for another number of points or matches; they run once untimed before each timing."""

UNLIMITED = 10**9
"""A limit on points or planes that no cloud and no method exceeds."""


class Entry(NamedTuple):
    """A method and how comparisons call it.

    Attributes:
        title: name of the method in tables.
        method: the method.
        drop_outliers: whether `detect` drops scattered outliers first; None: the default of the method.
        max_points: number of points to which `detect` thins larger clouds.
        max_planes: number of planes that `detect` keeps.
    """

    title: str
    method: Method
    drop_outliers: bool | None = None
    max_points: int = MAX_POINTS
    max_planes: int = MAX_PLANES

    def detect(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Detection:
        """Runs `symjax.detect` with the method and without warnings, which the detection's notes repeat."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SymjaxWarning)
            options = {name: getattr(self, name) for name in ("drop_outliers", "max_points", "max_planes")}
            return symjax.detect(points, self.method, rng=rng, **options)


def baseline_entry(title: str, method: Method) -> Entry:
    """Returns the entry of a baseline: it sees all points, thins them by itself, and all its planes are kept."""
    return Entry(title, method, max_points=UNLIMITED, max_planes=UNLIMITED)


ENTRIES: dict[str, Entry] = {
    OURS: Entry("symjax", Robust()),
    "sym-hks-printed": Entry("Algorithm 1 as printed", SymHKS.as_printed()),
    "sym-hks": Entry("Algorithm 1, our choices", SymHKS()),
    "sym-hks-cleaned": Entry("Algorithm 1, our choices, outliers dropped", SymHKS(), drop_outliers=True),
    "pca": baseline_entry("PCA", PCA()),
    "mle-printed": baseline_entry("MLE as printed", MaximumLikelihood(as_printed=True)),
    "mle": baseline_entry("MLE, corrected", MaximumLikelihood()),
    "ransac-matches": baseline_entry("RANSAC on matches", RansacOnMatches()),
    "ransac-points": baseline_entry("RANSAC on points", RansacOnPoints()),
    "ransac-released": baseline_entry("RANSAC on points, released stopping rule", RansacOnPoints.as_released()),
    "kazhdan": baseline_entry("Kazhdan", Kazhdan()),
    "cicconet": baseline_entry("Cicconet", Cicconet()),
    "hruda": baseline_entry("after Hruda", Hruda()),
    "3dsymm": baseline_entry("after 3DSymm, from PCA", ThreeDSymm()),
    "3dsymm-26": baseline_entry("after 3DSymm, from 26 starts", ThreeDSymm(starts="half-sphere")),
    "nagar-raman": baseline_entry("after Nagar and Raman 2019", NagarRaman()),
    PYCLARCS: baseline_entry("Combès (pyclarcs)", Pyclarcs()),
}
"""All methods, by their name on the command line and in result files, in the order of the tables."""


def usable(names: Iterable[str]) -> list[str]:
    """Returns the methods that can be run here; warns on stderr if a method is skipped because it is not installed."""
    names = list(names)
    if PYCLARCS in names and importlib.util.find_spec(PYCLARCS) is None:
        print(f"{PYCLARCS.upper()} IS NOT INSTALLED and is skipped: pip install {PYCLARCS}==0.4.4", file=sys.stderr)
        return [name for name in names if name != PYCLARCS]
    return names
