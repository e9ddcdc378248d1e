"""The methods of the arena by name: ours, the paper's, and the baselines.

One more method is one more file beside this one and one more line in `ENTRIES`.
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

PEER = "pyclarcs"
"""The one method that is another's package."""

COMPILED = ("kazhdan", "3dsymm-26", PEER)
"""Methods of which the first call in a process compiles what later ones need: its time says nothing of theirs."""

BY_SIZE = (OURS, "sym-hks-printed", "sym-hks", "sym-hks-cleaned")
"""Methods that may compile anew for another number of points, or of matches."""

ALL = 10**9
"""More points, and more planes, than there are."""


class Entry(NamedTuple):
    """A method of the arena.

    Attributes:
        title: what tables call it.
        method: the method.
        drop_outliers: whether scattered outliers are left out first; None leaves it to the method.
        max_points: larger clouds are thinned to this many before the method sees them.
        max_planes: most planes that count.
    """

    title: str
    method: Method
    drop_outliers: bool | None = None
    max_points: int = MAX_POINTS
    max_planes: int = MAX_PLANES

    def detect(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Detection:
        """What `symjax.detect` answers with the method; its warnings are left to the notes."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SymjaxWarning)
            options = {name: getattr(self, name) for name in ("drop_outliers", "max_points", "max_planes")}
            return symjax.detect(points, self.method, rng=rng, **options)


def baseline(title: str, method: Method) -> Entry:
    """A method that sees the points as they are, thins them itself, and of which all planes count."""
    return Entry(title, method, max_points=ALL, max_planes=ALL)


ENTRIES: dict[str, Entry] = {
    OURS: Entry("symjax", Robust()),
    "sym-hks-printed": Entry("Algorithm 1 as printed", SymHKS.as_printed()),
    "sym-hks": Entry("Algorithm 1, our choices", SymHKS()),
    "sym-hks-cleaned": Entry("Algorithm 1, our choices, outliers dropped", SymHKS(), drop_outliers=True),
    "pca": baseline("PCA", PCA()),
    "mle-printed": baseline("MLE as printed", MaximumLikelihood(as_printed=True)),
    "mle": baseline("MLE, corrected", MaximumLikelihood()),
    "ransac-matches": baseline("RANSAC on matches", RansacOnMatches()),
    "ransac-points": baseline("RANSAC on points", RansacOnPoints()),
    "ransac-released": baseline("RANSAC on points, released stopping rule", RansacOnPoints.as_released()),
    "kazhdan": baseline("Kazhdan", Kazhdan()),
    "cicconet": baseline("Cicconet", Cicconet()),
    "hruda": baseline("after Hruda", Hruda()),
    "3dsymm": baseline("after 3DSymm, from PCA", ThreeDSymm()),
    "3dsymm-26": baseline("after 3DSymm, from 26 starts", ThreeDSymm(starts="half-sphere")),
    "nagar-raman": baseline("after Nagar and Raman 2019", NagarRaman()),
    PEER: baseline("Combès (pyclarcs)", Pyclarcs()),
}
"""By the name on the command line."""


def usable(names: Iterable[str]) -> list[str]:
    """Those methods that can be run; says so loudly where one cannot."""
    names = list(names)
    if PEER in names and importlib.util.find_spec(PEER) is None:
        print(f"{PEER.upper()} IS NOT INSTALLED: pip install {PEER}==0.4.4. Skipped.", file=sys.stderr)
        return [name for name in names if name != PEER]
    return names
