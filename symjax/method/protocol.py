"""The Protocol that `symjax.detect` expects of a method. `Robust` and `SymHKS` implement it, and so can others."""

from typing import Protocol, runtime_checkable

import numpy as np

from symjax.method.result import MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud


@runtime_checkable
class Method(Protocol):
    """A method finds the mirror planes of a cloud. It is best written as a frozen dataclass of its options.

    Example:
        A method that always returns the plane x = 0 of the cloud frame:

        >>> from dataclasses import dataclass
        >>> import symjax
        >>> @dataclass(frozen=True)
        ... class FirstAxis:
        ...     name: str = "first axis"
        ...     drops_outliers: bool = False
        ...     def find(self, cloud, *, max_planes, rng, timer):
        ...         plane = symjax.Plane(np.array([1.0, 0.0, 0.0]), np.array(0.0))
        ...         with timer.stage("choosing"):
        ...             candidate = symjax.Candidate(plane, score=1.0, ranking_score=1.0)
        ...         return symjax.MethodResult((candidate,), (plane,), "one plane")
        >>> isinstance(FirstAxis(), symjax.Method)
        True
    """

    @property
    def name(self) -> str:
        """Name of the method, which is stored in the detection."""
        ...

    @property
    def drops_outliers(self) -> bool:
        """Default of `drop_outliers`: whether `detect` removes outliers before it calls the method."""
        ...

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud.

        Args:
            cloud: distinct points in the cloud frame, in units of the diagonal, with normals if they were given.
            max_planes: largest number of candidates that `detect` keeps; the method may stop there.
            rng: generator for all random numbers.
            timer: `with timer.stage("name"):` announces and times a stage.

        Returns:
            Planes and pairs in the cloud frame; `detect` converts them to the units of the input points.
        """
        ...
