"""The methods that are compared, each as a function from points to an answer."""

import importlib.util
import sys
import warnings
from collections.abc import Callable
from functools import partial
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

import symjax
from symjax.errors import SymjaxWarning
from symjax.plane import Plane

PEER = "pyclarcs"
"""EM-ICP (Combès et al., CVPR 2008), the one other package that takes bare points: `pip install pyclarcs==0.4.4`."""

PEER_DIAGONAL = 200.0
"""Its scales are in millimetres and meant for a head."""


class Answer(NamedTuple):
    """What a method says of a cloud.

    Attributes:
        plane: the plane; None where the method gave up.
        found: whether the method takes it for a symmetry.
        ambiguous: whether it says that others are as good.
        seconds: that it took.
        error: why it gave up.
    """

    plane: Plane | None
    found: bool
    ambiguous: bool
    seconds: float
    error: str = ""


def _symjax(points: Float[np.ndarray, "n 3"], **options: Any) -> tuple[Plane, bool, bool]:
    found = symjax.detect(points, rng=0, **options)
    return found.plane, found.found, found.ambiguous


def _peer(points: Float[np.ndarray, "n 3"]) -> tuple[Plane, bool, bool]:
    """All stages of its command `clarcs symplane`; it always answers and never doubts."""
    from pyclarcs.coarse import coarse_symmetry
    from pyclarcs.fine import em_icp_sym, em_icp_sym_corres
    from pyclarcs.principal_axes import best_principal_axis_plane

    centre = points.mean(axis=0)
    scale = PEER_DIAGONAL / float(np.linalg.norm(np.ptp(points, axis=0)))
    scaled = scale * (points - centre)
    plane = coarse_symmetry(scaled, best_principal_axis_plane(scaled), seed=0)
    plane = em_icp_sym_corres(scaled, em_icp_sym(scaled, plane))
    return Plane(plane.n, np.asarray(plane.d / scale + plane.n @ centre)), True, False


METHODS: dict[str, Callable[[Float[np.ndarray, "n 3"]], tuple[Plane, bool, bool]]] = {
    "robust": partial(_symjax, method="robust"),
    "sym-hks": partial(_symjax, method="sym-hks"),
    "sym-hks-cleaned": partial(_symjax, method="sym-hks", drop_outliers=True),
    PEER: _peer,
}
"""By name: plane, whether it is a symmetry, and whether there are others."""


def usable(names: list[str]) -> list[str]:
    """Those methods that can be run; says so loudly where one cannot."""
    if PEER in names and importlib.util.find_spec(PEER) is None:
        print(f"{PEER.upper()} IS NOT INSTALLED: pip install {PEER}==0.4.4. Skipped.", file=sys.stderr)
        return [name for name in names if name != PEER]
    return names


def answer(method: str, points: Float[np.ndarray, "n 3"]) -> Answer:
    """What a method says of a cloud. One that raises has given no answer, whatever it raises."""
    start = perf_counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SymjaxWarning)
            plane, found, ambiguous = METHODS[method](points)
    except Exception as error:
        return Answer(None, False, False, perf_counter() - start, repr(error))
    return Answer(plane, found, ambiguous, perf_counter() - start)
