"""symjax: the mirror plane of a 3D point cloud, by a robust and differentiable estimator.

`import symjax` is cheap: JAX is imported when a name that needs it is first used, so that
`symjax --help` and a mistyped path answer at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from symjax.errors import SymjaxError, SymjaxWarning

if TYPE_CHECKING:
    from symjax import metrics, samples
    from symjax.compilation import enable_compilation_cache
    from symjax.detection import Detection, load
    from symjax.files.pointfile import read_points
    from symjax.fit import Fit, best
    from symjax.fitting import fit_global, fit_plane
    from symjax.objective import l2e_loss
    from symjax.pipeline import detect
    from symjax.plane import Plane
    from symjax.sandwich import StandardErrors, standard_errors
    from symjax.sweeping import sweep, sweep_clouds
    from symjax.symhks.correspondences import SymHKS

__version__ = "0.1.0"

_HOME = {
    "Detection": "symjax.detection",
    "Fit": "symjax.fit",
    "Plane": "symjax.plane",
    "StandardErrors": "symjax.sandwich",
    "SymHKS": "symjax.symhks.correspondences",
    "best": "symjax.fit",
    "detect": "symjax.pipeline",
    "enable_compilation_cache": "symjax.compilation",
    "fit_global": "symjax.fitting",
    "fit_plane": "symjax.fitting",
    "l2e_loss": "symjax.objective",
    "load": "symjax.detection",
    "read_points": "symjax.files.pointfile",
    "standard_errors": "symjax.sandwich",
    "sweep": "symjax.sweeping",
    "sweep_clouds": "symjax.sweeping",
}
_MODULES = ("metrics", "samples")

__all__ = [
    "Detection",
    "Fit",
    "Plane",
    "StandardErrors",
    "SymHKS",
    "SymjaxError",
    "SymjaxWarning",
    "best",
    "detect",
    "enable_compilation_cache",
    "fit_global",
    "fit_plane",
    "l2e_loss",
    "load",
    "metrics",
    "read_points",
    "samples",
    "standard_errors",
    "sweep",
    "sweep_clouds",
]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(f"symjax.{name}")
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'symjax' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
