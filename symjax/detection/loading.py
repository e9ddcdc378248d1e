"""Reading a detection from the JSON file that `Detection.save` wrote."""

import json
import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from symjax.detection.result import Detection, Pairs
from symjax.detection.serialisation import FORMAT
from symjax.errors import FileFormatError
from symjax.geometry.checks import as_path
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.method.result import Axis, Candidate


def load(path: str | os.PathLike[str], *, points: ArrayLike | None = None) -> Detection:
    """Reads a detection from a file that `Detection.save` wrote.

    Args:
        path: the JSON file.
        points: the points that the plane was detected in. The file does not contain them, and the methods that need
            them (`plot`, `picture`, `on_surface`, `complete` and `asymmetry`) raise an error without them.

    Returns:
        The detection, with the given points.

    Raises:
        FileFormatError: if the file is missing or unreadable, or is not a complete detection.

    Example:
        >>> import tempfile
        >>> from pathlib import Path
        >>> import symjax
        >>> sample = symjax.datasets.generate("quadruped", num_points=600, rng=0)
        >>> det = symjax.detect(sample.points)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     det.save(Path(folder) / "detection.json")
        ...     loaded = symjax.load(Path(folder) / "detection.json", points=sample.points)
        >>> float(loaded.plane.angle(det.plane))
        0.0
        >>> loaded.complete().shape
        (1200, 3)
    """
    try:
        values = json.loads(as_path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise FileFormatError(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:
        raise FileFormatError(f"{path} is not JSON: {error}") from error
    if not isinstance(values, dict) or values.pop("format", None) != FORMAT:
        raise FileFormatError(f"{path} was not written by Detection.save: its format is not {FORMAT!r}")
    try:
        pairs = values.pop("pairs")
        return Detection(
            plane=_plane(values.pop("plane")),
            axis=_axis(values.pop("axis")),
            planes=tuple(_plane(plane) for plane in values.pop("planes")),
            candidates=tuple(
                Candidate(_plane(c["plane"]), float(c["score"]), float(c["ranking_score"]), c["exactness"])
                for c in values.pop("candidates")
            ),
            uncertainty=_uncertainty(values.pop("uncertainty")),
            pairs=Pairs(
                np.array(pairs["x"], dtype=float).reshape(-1, 3),
                np.array(pairs["y"], dtype=float).reshape(-1, 3),
                np.array(pairs["rows"], dtype=np.int64).reshape(-1, 2),
                np.array(pairs["weight"], dtype=float),
            ),
            used=np.array(values.pop("used"), dtype=np.int64),
            notes=tuple(values.pop("notes")),
            points=None if points is None else np.asarray(points, dtype=float),
            **values,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise FileFormatError(f"{path} is not a complete detection: {error}") from error


def _plane(values: dict[str, Any]) -> Plane:
    normal, offset = (np.array(values[name], dtype=float) for name in ("normal", "offset"))
    return Plane(normal.reshape(3), offset.reshape(()))


def _axis(values: list[list[float]] | None) -> Axis | None:
    if values is None:
        return None
    point, direction = (np.array(value, dtype=float).reshape(3) for value in values)
    return point, direction


def _uncertainty(values: dict[str, Any] | None) -> Uncertainty | None:
    if values is None:
        return None
    shapes = {"covariance": (3, 3), "tangents": (2, 3), "centre": (3,)}
    return Uncertainty(**{name: np.array(values[name], dtype=float).reshape(s) for name, s in shapes.items()})
