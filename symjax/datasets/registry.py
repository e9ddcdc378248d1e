"""The real models that can be downloaded: where each comes from, and what is known of its symmetry."""

import json
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np

from symjax.geometry.plane import Plane


class Original(NamedTuple):
    """A published file, pinned to one version of it, and its mirror plane.

    Attributes:
        url: address.
        sha256: of the file, in hexadecimal.
        num_bytes: size of the download.
        licence: of the model; it may ask that the attribution be given.
        attribution: whom to name.
        normal: unit normal of the mirror plane; None if no one plane is known.
        offset: of the plane, in the file's own units.
        symmetry: how exact the plane is, or why none is given.
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
        """The mirror plane, in arrays of the caller's own."""
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
"""Every model by name; `MODELS[name].licence`, `MODELS[name].symmetry`."""
