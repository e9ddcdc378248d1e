"""The real models that can be downloaded: their sources, and their known mirror planes."""

import json
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np

from symjax.geometry.plane import Plane


class Original(NamedTuple):
    """One version of a published file, and its mirror plane.

    Attributes:
        url: address of the file.
        sha256: hash of the file, in hexadecimal.
        num_bytes: size of the file in bytes.
        licence: licence of the model; it may require the attribution.
        attribution: names of the authors.
        normal: unit normal of the mirror plane; None if no single plane is known.
        offset: offset of the plane, in the units of the file; None if no single plane is known.
        symmetry: how exact the plane is, or why no plane is given.

    Example:
        >>> import symjax
        >>> spot = symjax.datasets.MODELS["spot"]
        >>> spot.attribution, spot.licence, spot.normal, spot.symmetry
        ('Keenan Crane', 'public domain', (1, 0, 0), 'exact')
    """

    url: str
    sha256: str
    num_bytes: int
    licence: str
    attribution: str
    normal: tuple[float, float, float] | None
    offset: float | None
    symmetry: str

    @property
    def plane(self) -> Plane | None:
        """The mirror plane as new arrays; None if no single plane is known."""
        if self.normal is None or self.offset is None:
            return None
        return Plane(np.array(self.normal, np.float64), np.array(self.offset, np.float64))


def _read() -> dict[str, Original]:
    text = (files("symjax.datasets") / "registry.json").read_text(encoding="utf-8")
    return {name: _original(entry) for name, entry in json.loads(text).items()}


def _original(entry: dict[str, Any]) -> Original:
    plane = entry["plane"] or {"normal": None, "offset": None}
    return Original(
        url=entry["url"],
        sha256=entry["sha256"],
        num_bytes=entry["bytes"],
        licence=entry["licence"],
        attribution=entry["attribution"],
        normal=plane["normal"] and tuple(plane["normal"]),
        offset=plane["offset"],
        symmetry=entry["symmetry"],
    )


MODELS: dict[str, Original] = _read()
"""All models, by name."""
