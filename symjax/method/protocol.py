"""What `symjax.detect` asks of a method: symjax's own are `Robust` and `SymHKS`; anybody's will do."""

from typing import Protocol, runtime_checkable

import numpy as np

from symjax.method.result import MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud


@runtime_checkable
class Method(Protocol):
    """A way to find the mirror planes of a cloud: best a frozen dataclass of its options.

    Example:
        A method that answers with the plane x = 0 of the cloud's own frame:

        >>> from dataclasses import dataclass
        >>> from symjax.geometry.plane import Plane
        >>> from symjax.method.result import Candidate
        >>> @dataclass(frozen=True)
        ... class First:
        ...     name: str = "first axis"
        ...     drops_outliers: bool = False
        ...     def find(self, cloud, *, max_planes, rng, timer):
        ...         plane = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))
        ...         return MethodResult((Candidate(plane, 1.0, 1.0),), (plane,), "one plane")
        >>> isinstance(First(), Method)
        True
    """

    @property
    def name(self) -> str:
        """Name of the method, kept in the detection."""
        ...

    @property
    def drops_outliers(self) -> bool:
        """Whether `detect` leaves scattered outliers out first, unless `drop_outliers` is given."""
        ...

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror planes of a cloud.

        Args:
            cloud: distinct points in their own frame, in units of their diagonal, with normals if they were given.
            max_planes: most candidates that `detect` keeps; a method may stop there.
            rng: generator of everything random.
            timer: `with timer.stage("name"):` announces and times a stage.
        """
        ...
