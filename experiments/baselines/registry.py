"""The methods of the arena by name: ours, the paper's, and the rivals.

One more method is one more file beside this one and one more line in `ENTRIES`.
"""

import importlib.util
import sys
import warnings
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float

import symjax
from experiments.baselines import (
    cicconet,
    hruda,
    kazhdan,
    maximum_likelihood,
    nagar_raman,
    pca,
    pyclarcs_em,
    ransac_matches,
    ransac_points,
    three_d_symm,
)
from experiments.baselines.ranking import Ranking, Rival
from experiments.studies.symhks import choices
from symjax.errors import SymjaxWarning
from symjax.geometry.plane import Plane

OURS = "robust"
"""The default of `symjax.detect`."""

PEER = "pyclarcs"
"""The one method that is another's package."""

COMPILED = ("kazhdan", "3dsymm-26", PEER)
"""Methods of which the first call in a process compiles what later ones need: its time says nothing of theirs."""

AS_PRINTED = choices.AS_PRINTED.arguments_of_detect
"""The paper's choices, where it says any; likelihood and RANSAC on matches have the matches of ours."""

BY_SIZE = (OURS, "sym-hks-printed", "sym-hks", "sym-hks-cleaned")
"""Methods that may compile anew for another number of points, or of matches."""


MOST_MERIT = 2.0
"""No candidate of symjax has as much."""


class Proposal(NamedTuple):
    """What a method says of a cloud.

    Attributes:
        ranking: all planes that it looked at in the end, the best first.
        held: which of them it takes for mirror planes: all, unless it can doubt.
        ambiguous: whether it says that others are as good as the first.
    """

    ranking: Ranking
    held: Bool[np.ndarray, "k"]
    ambiguous: bool = False

    @property
    def found(self) -> bool:
        """Whether it takes any for a mirror plane."""
        return bool(self.held.any())


class Entry(NamedTuple):
    """A method.

    Attributes:
        title: what tables call it.
        propose: what it says of points, given a generator of its randomness.
    """

    title: str
    propose: Callable[[Float[np.ndarray, "n 3"], np.random.Generator], Proposal]


def _symjax(points: Float[np.ndarray, "n 3"], rng: np.random.Generator, **options: Any) -> Proposal:
    """Candidates by their merit, which is what symjax ranks them by, behind those that are its mirror planes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SymjaxWarning)
        said = symjax.detect(points, rng=rng, **options)
    planes = [candidate.plane for candidate in said.candidates]
    normals, offsets = (np.array(part, float) for part in zip(*planes, strict=True))
    canonical = Plane(normals, offsets).canonical()
    # a candidate that was not polished stands behind those that were, whatever its merit
    merits = np.minimum.accumulate([candidate.merit for candidate in said.candidates])
    held = np.array([any(_same(plane, mirror) for mirror in said.planes) for plane in planes])
    scores = np.where(held, merits, merits - MOST_MERIT)
    order = np.argsort(-scores, kind="stable")
    ranking = Ranking(np.asarray(canonical.normal)[order], np.asarray(canonical.offset)[order], scores[order])
    return Proposal(ranking, held[order], said.ambiguous)


def _same(plane: Plane, other: Plane) -> bool:
    return np.array_equal(plane.normal, other.normal) and float(plane.offset) == float(other.offset)


def _rival(
    points: Float[np.ndarray, "n 3"], rng: np.random.Generator, *, find: Rival, several: bool, **options: Any
) -> Proposal:
    """A method that never doubts its best plane; it holds the others if it lists only what its own rule accepts."""
    ranking = find(points, rng=rng, **options)
    return Proposal(ranking, np.full(len(ranking.offsets), several) | (np.arange(len(ranking.offsets)) == 0))


def _entry(title: str, find: Rival, *, several: bool = False, **options: Any) -> Entry:
    return Entry(title, partial(_rival, find=find, several=several, **options))


ENTRIES: dict[str, Entry] = {
    OURS: Entry("symjax", partial(_symjax, method="robust")),
    "sym-hks-printed": Entry("Algorithm 1 as printed", partial(_symjax, method="sym-hks", **AS_PRINTED)),
    "sym-hks": Entry("Algorithm 1, our choices", partial(_symjax, method="sym-hks")),
    "sym-hks-cleaned": Entry(
        "Algorithm 1, our choices, outliers dropped", partial(_symjax, method="sym-hks", drop_outliers=True)
    ),
    "pca": _entry("PCA", pca.find),
    "mle-printed": _entry("MLE as printed", maximum_likelihood.find, as_printed=True),
    "mle": _entry("MLE, corrected", maximum_likelihood.find),
    "ransac-matches": _entry("RANSAC on matches", ransac_matches.find, several=True),
    "ransac-points": _entry("RANSAC on points", ransac_points.find, several=True),
    "ransac-released": _entry(
        "RANSAC on points, released stopping rule",
        ransac_points.find,
        radius=0.05,
        confidence=0.95,
        draws=1000,
        judges=None,
        refits=0,
    ),
    "kazhdan": _entry("Kazhdan", kazhdan.find),
    "cicconet": _entry("Cicconet", cicconet.find),
    "hruda": _entry("after Hruda", hruda.find, several=True),
    "3dsymm": _entry("after 3DSymm, from PCA", three_d_symm.find),
    "3dsymm-26": _entry("after 3DSymm, from 26 starts", three_d_symm.find, starts="half-sphere"),
    "nagar-raman": _entry("after Nagar and Raman 2019", nagar_raman.find),
    PEER: _entry("Combès (pyclarcs)", pyclarcs_em.find),
}
"""By the name on the command line."""


def usable(names: Iterable[str]) -> list[str]:
    """Those methods that can be run; says so loudly where one cannot."""
    names = list(names)
    if PEER in names and importlib.util.find_spec(PEER) is None:
        print(f"{PEER.upper()} IS NOT INSTALLED: pip install {PEER}==0.4.4. Skipped.", file=sys.stderr)
        return [name for name in names if name != PEER]
    return names
