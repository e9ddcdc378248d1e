"""symjax: finds the mirror plane of a 3D point cloud with a robust, differentiable estimator.

`detect` finds the mirror planes of a cloud and returns a `Detection`. `fit_plane`, `fit_global` and `sweep` fit one
plane to pairs of points that may be mirror images, and return a `Fit`.

`import symjax` is fast: JAX is imported when a name that needs it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from symjax.errors import SymjaxError, SymjaxWarning

if TYPE_CHECKING:
    from symjax import datasets
    from symjax.detection.detect import detect
    from symjax.detection.loading import load
    from symjax.detection.result import Detection
    from symjax.geometry import distance as metrics
    from symjax.geometry.plane import Plane
    from symjax.io.points import read_points
    from symjax.l2e.fit import Fit, best
    from symjax.l2e.fit_global import fit_global
    from symjax.l2e.fit_plane import fit_plane
    from symjax.l2e.jax_config import enable_compilation_cache
    from symjax.l2e.objective import l2e_loss
    from symjax.l2e.standard_errors import StandardErrors, standard_errors
    from symjax.l2e.sweep import sweep, sweep_clouds
    from symjax.method.protocol import Method
    from symjax.method.result import Candidate, MethodResult
    from symjax.method.stage_timer import StageTimer
    from symjax.preprocess.cloud import Cloud
    from symjax.robust.method import Robust
    from symjax.robust.verification.thresholds import FoundThresholds
    from symjax.symhks.method import SymHKS

__version__ = "0.2.0"

_HOME = {
    "Candidate": "symjax.method.result",
    "Cloud": "symjax.preprocess.cloud",
    "Detection": "symjax.detection.result",
    "Fit": "symjax.l2e.fit",
    "FoundThresholds": "symjax.robust.verification.thresholds",
    "Method": "symjax.method.protocol",
    "MethodResult": "symjax.method.result",
    "Plane": "symjax.geometry.plane",
    "Robust": "symjax.robust.method",
    "StageTimer": "symjax.method.stage_timer",
    "StandardErrors": "symjax.l2e.standard_errors",
    "SymHKS": "symjax.symhks.method",
    "best": "symjax.l2e.fit",
    "detect": "symjax.detection.detect",
    "enable_compilation_cache": "symjax.l2e.jax_config",
    "fit_global": "symjax.l2e.fit_global",
    "fit_plane": "symjax.l2e.fit_plane",
    "l2e_loss": "symjax.l2e.objective",
    "load": "symjax.detection.loading",
    "read_points": "symjax.io.points",
    "standard_errors": "symjax.l2e.standard_errors",
    "sweep": "symjax.l2e.sweep",
    "sweep_clouds": "symjax.l2e.sweep",
}
_MODULES = {"datasets": "symjax.datasets", "metrics": "symjax.geometry.distance"}

__all__ = [
    "Candidate",
    "Cloud",
    "Detection",
    "Fit",
    "FoundThresholds",
    "Method",
    "MethodResult",
    "Plane",
    "Robust",
    "StageTimer",
    "StandardErrors",
    "SymHKS",
    "SymjaxError",
    "SymjaxWarning",
    "best",
    "datasets",
    "detect",
    "enable_compilation_cache",
    "fit_global",
    "fit_plane",
    "l2e_loss",
    "load",
    "metrics",
    "read_points",
    "standard_errors",
    "sweep",
    "sweep_clouds",
]


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        return import_module(_MODULES[name])
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module 'symjax' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))
