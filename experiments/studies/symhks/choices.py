"""The choices of Sym-HKS, and what is put in their place: options where there are some, replaced parts elsewhere."""

from functools import partial
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
import robust_laplacian
from jaxtyping import Float
from scipy.sparse import csc_matrix

from symjax.l2e.pairs.padded import Pairs
from symjax.symhks import correspondences, keypoints, method, plane_fit, spectrum
from symjax.symhks.method import SymHKS

Patch = tuple[ModuleType, str, Any]

UNBOUNDED = 10**9
"""Neighbours that no radius holds."""

WIDEST = 0.5
"""Radius, in diagonals, that bounds no number of neighbours."""


class Variant(NamedTuple):
    """Sym-HKS with something changed.

    Attributes:
        options: of the correspondences.
        arguments: further arguments of `symjax.detect`, by name.
        patches: what takes the place of parts without a switch: module, name, replacement.
    """

    options: SymHKS = SymHKS()
    arguments: tuple[tuple[str, Any], ...] = ()
    patches: tuple[Patch, ...] = ()

    @property
    def arguments_of_detect(self) -> dict[str, Any]:
        """Options and arguments of `symjax.detect`, by name."""
        return {"options": self.options, **dict(self.arguments)}


DEFAULT = Variant()


def _options(**changed: Any) -> Variant:
    return Variant(options=SymHKS(**changed))


def _arguments(**changed: Any) -> Variant:
    return Variant(arguments=tuple(changed.items()))


def _patched(module: ModuleType, name: str, value: Any, **options: Any) -> Variant:
    """The default where the value is the package's own."""
    patches = () if getattr(module, name) == value else ((module, name, value),)
    return Variant(options=SymHKS(**options), patches=patches)


def _star(neighbours: int) -> Variant:
    if neighbours == spectrum.STAR_NEIGHBOURS:
        return DEFAULT
    return _patched(correspondences, "spectrum", partial(spectrum.spectrum, num_neighbours=neighbours))


def _library_laplacian(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    num_neighbours: int = spectrum.STAR_NEIGHBOURS,
) -> tuple[csc_matrix, Float[np.ndarray, "n"]]:
    """Sharp and Crane's Laplacian of points as their library has it, which estimates normals itself."""
    matrix, mass = robust_laplacian.point_cloud_laplacian(
        np.ascontiguousarray(points, dtype=float), n_neighbors=min(num_neighbours, len(points) - 1)
    )
    return csc_matrix(matrix), mass.diagonal()


def _named_start(row: int) -> Variant:
    """One of the three named starts, alone."""

    def start(pairs: Pairs, sigma: float, restarts: int) -> Float[np.ndarray, "1 3"]:
        return np.asarray(plane_fit._named_starts(pairs))[row : row + 1]

    return _patched(plane_fit, "_starts", start)


AS_PRINTED = Variant(
    SymHKS(times="uniform", whitened=False, separation=0.0),
    (("restarts", 1), ("solver", "alternating")),
)
"""What the paper says, where it says something; keypoints, pairs and σ, of which it gives no number, stay ours."""

CHOICES: dict[str, dict[str | float, Variant]] = {
    "eigenfunctions k": {k: _options(num_eigs=k) for k in (5, 10, 20, 30, 50)},
    "times p": {p: _options(num_times=p) for p in (4, 8, 16, 32, 64)},
    "range of times": {
        "Sun et al.": _options(times="logarithmic"),
        "paper": _options(times="uniform"),
    },
    "distance of signatures": {
        "Mahalanobis": _options(whitened=True),
        "Euclidean (paper)": _options(whitened=False),
    },
    "neighbours h": {
        "both bounds": DEFAULT,
        **{h: _patched(keypoints, "NUM_NEIGHBOURS", h, radius=WIDEST) for h in (25, 50, 100, 200)},
    },
    "radius r": {
        "both bounds": DEFAULT,
        **{r: _patched(keypoints, "NUM_NEIGHBOURS", UNBOUNDED, radius=r) for r in (0.025, 0.05, 0.1, 0.15)},
    },
    "keypoints": {a: _options(num_keypoints=a) for a in (100, 200, 300, 500, 800)},
    "pairs per keypoint": {share: _patched(correspondences, "PAIRS_PER_KEYPOINT", share) for share in (0.1, 0.25, 0.4)},
    "signs (0: off)": {s: _options(num_signs=s) for s in (0, 4, 8, 12, 19)},
    "separation in spacings (0: paper)": {s: _options(separation=s) for s in (0.0, 1.0, 1.9, 3.0)},
    "Laplacian": {
        "own stars": DEFAULT,
        "library's": _patched(spectrum, "laplacian", _library_laplacian),
    },
    "neighbours of a star": {h: _star(h) for h in (10, 20, 30, 50)},
    "front end": {
        "by condition": DEFAULT,
        "off": _arguments(drop_outliers=False),
        "on": _arguments(drop_outliers=True),
    },
    "start": {
        "64": DEFAULT,
        "Grassmann average (paper)": _named_start(0),
        "principal direction": _named_start(1),
        "least squares": _named_start(2),
    },
    "starts": {
        restarts: DEFAULT if restarts == method.RESTARTS else _arguments(restarts=restarts)
        for restarts in (1, 3, 16, 64)
    },
    "solver": {
        "joint": DEFAULT,
        **{name: _arguments(solver=name) for name in ("alternating", "newton", "mm")},
    },
    "sigma in spacings": {factor: _patched(method, "SIGMA_SPACINGS", factor) for factor in (0.35, 0.7, 1.4, 2.8, 5.6)},
    "all together": {"default": DEFAULT, "as printed": AS_PRINTED},
}
"""By choice and value; a value that is the default's own gives the default. Numbers are drawn, names are not."""
