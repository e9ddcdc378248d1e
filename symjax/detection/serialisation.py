"""A result as JSON: everything but the points."""

import json
import os
from dataclasses import fields
from typing import Any

import numpy as np

from symjax.io.atomic import replacing

FORMAT = "symjax detection 3"


def to_dict(detection: Any) -> dict[str, Any]:
    """Everything of a dataclass but its points, as numbers, strings, lists and dictionaries that JSON holds."""
    values = {f.name: getattr(detection, f.name) for f in fields(detection) if f.name != "points"}
    return {"format": FORMAT, **_plain(values)}


def save(detection: Any, path: str | os.PathLike[str]) -> None:
    """Writes `to_dict` as JSON; `symjax.load` reads it back, without the points."""
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(to_dict(detection), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    """NumPy and named tuples as what JSON knows."""
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return value
