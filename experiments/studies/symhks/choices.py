"""The choices of Sym-HKS and their alternatives."""

from typing import Any, NamedTuple

from symjax import SymHKS

WIDEST = 0.5
"""Radius in diagonals that is too large to limit the number of neighbours."""


class Variant(NamedTuple):
    """Sym-HKS with changed options.

    Attributes:
        method: the method.
        drop_outliers: whether outliers are removed first; None means that the condition decides.
    """

    method: SymHKS = SymHKS()
    drop_outliers: bool | None = None


DEFAULT = Variant()


def _changed(**options: Any) -> Variant:
    return Variant(SymHKS(**options))


CHOICES: dict[str, dict[str | float, Variant]] = {
    "eigenfunctions k": {k: _changed(num_eigs=k) for k in (5, 10, 20, 30, 50)},
    "times p": {p: _changed(num_times=p) for p in (4, 8, 16, 32, 64)},
    "range of times": {"Sun et al.": _changed(times="logarithmic"), "paper": _changed(times="uniform")},
    "distance of signatures": {"Mahalanobis": _changed(whitened=True), "Euclidean (paper)": _changed(whitened=False)},
    "neighbours h": {"both bounds": DEFAULT}
    | {h: _changed(num_neighbours=h, radius=WIDEST) for h in (25, 50, 100, 200)},
    "radius r": {"both bounds": DEFAULT}
    | {r: _changed(num_neighbours=None, radius=r) for r in (0.025, 0.05, 0.1, 0.15)},
    "keypoints": {a: _changed(num_keypoints=a) for a in (100, 200, 300, 500, 800)},
    "pairs per keypoint": {share: _changed(pairs_per_keypoint=share) for share in (0.1, 0.25, 0.4)},
    "signs (0: off)": {s: _changed(num_signs=s) for s in (0, 4, 8, 12, 19)},
    "separation in spacings (0: paper)": {s: _changed(separation=s) for s in (0.0, 1.0, 1.9, 3.0)},
    "Laplacian": {"stars": _changed(laplacian="stars"), "library": _changed(laplacian="library")},
    "neighbours of a star": {h: _changed(star_neighbours=h) for h in (10, 20, 30, 50)},
    "outlier removal": {
        "by condition": DEFAULT,
        "off": Variant(drop_outliers=False),
        "on": Variant(drop_outliers=True),
    },
    "start": {
        "64": DEFAULT,
        "Grassmann average (paper)": _changed(starts="rga"),
        "principal direction": _changed(starts="pca"),
        "least squares": _changed(starts="l2"),
    },
    "starts": {restarts: _changed(restarts=restarts) for restarts in (1, 3, 16, 64)},
    "solver": {
        "Riemannian BFGS": DEFAULT,
        **{name: _changed(solver=name) for name in ("alternating", "newton", "irls")},
    },
    "sigma in spacings": {factor: _changed(sigma_spacings=factor) for factor in (0.35, 0.7, 1.4, 2.8, 5.6)},
    "all together": {"default": DEFAULT, "as printed": Variant(SymHKS.as_printed())},
}
"""Variants by choice and value; a value equal to the default's gives `DEFAULT`. The figure has the numeric values only.
"""
