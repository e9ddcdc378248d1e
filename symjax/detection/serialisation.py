"""Writing a detection as JSON, without its points."""

import json
import os
from dataclasses import fields
from typing import Any

import numpy as np

from symjax.io.atomic import replacing

FORMAT = "symjax detection 3"


def to_dict(detection: Any) -> dict[str, Any]:
    """Returns the fields of a detection, except its points, as values that JSON can represent."""
    values = {f.name: getattr(detection, f.name) for f in fields(detection) if f.name != "points"}
    return {"format": FORMAT, **_plain(values)}


def save(detection: Any, path: str | os.PathLike[str]) -> None:
    """Writes the dictionary of `to_dict` to a JSON file."""
    with replacing(path) as temporary:
        temporary.write_text(json.dumps(to_dict(detection), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _plain(value: Any) -> Any:
    """Converts arrays and named tuples to lists and dictionaries."""
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return value
