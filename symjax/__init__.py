"""symjax: the mirror plane of a 3D point cloud, by a robust and differentiable estimator.

`import symjax` is cheap: JAX is imported when a name that needs it is first used, so that
`symjax --help` and a mistyped path answer at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from symjax.errors import SymjaxError, SymjaxWarning

if TYPE_CHECKING:
    from symjax import metrics, samples
    from symjax.detection import Detection, load
    from symjax.files.pointfile import read_points
    from symjax.fit import Fit, best, fit_plane, sweep
    from symjax.objective import l2e_loss
    from symjax.pipeline import detect
    from symjax.plane import Plane
    from symjax.symhks.correspondences import SymHKS

__version__ = "0.1.0"

_HOME = {
    "Detection": "symjax.detection",
    "Fit": "symjax.fit",
    "Plane": "symjax.plane",
    "SymHKS": "symjax.symhks.correspondences",
    "best": "symjax.fit",
    "detect": "symjax.pipeline",
    "fit_plane": "symjax.fit",
    "l2e_loss": "symjax.objective",
    "load": "symjax.detection",
    "read_points": "symjax.files.pointfile",
    "sweep": "symjax.fit",
}
_MODULES = ("metrics", "samples")

__all__ = [
    "Detection",
    "Fit",
    "Plane",
    "SymHKS",
    "SymjaxError",
    "SymjaxWarning",
    "best",
    "detect",
    "fit_plane",
    "l2e_loss",
    "load",
    "metrics",
    "read_points",
    "samples",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"symjax.{name}")
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'symjax' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
