"""Reads a `planes.json`: the objects of a folder and their true planes.

```json
{"boat": {"file": "models/boat.obj", "normal": [1, 0, 0], "offset": -3.25, "kind": "exact"},
 "box": {"file": "box.ply", "planes": [{"normal": [1, 0, 0], "offset": 0}, {"normal": [0, 1, 0], "offset": 0}]},
 "stone": {"file": "stone.stl", "normal": null, "kind": "none"}}
```

A key is the name of an object. Its entry has the following fields:

- `file`: path of the mesh or cloud, relative to the listing.
- `normal` and `offset`: the mirror plane, normal · x = offset, in the units and the frame of the file. The normal need
  not be of unit length: both are divided by its length. `"normal": null` means that the object has no mirror plane.
- `planes`: a list of such planes instead, if the object has several; an empty list means none.
- `kind`: the group in which studies report the object; text after a colon or a semicolon is a remark. Optional.

To add data of your own, write this file and pass its folder as `--data FOLDER`. A published benchmark with another
layout needs a loader instead: see `experiments.data`.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from symjax.errors import FileFormatError
from symjax.geometry.plane import Plane

LISTING = "planes.json"


class Entry(NamedTuple):
    """One object of a listing.

    Attributes:
        file: path of the mesh or cloud, relative to the listing.
        planes: true mirror planes, with unit normals; empty if the object has none.
        kind: group of the object; may be empty.
    """

    file: str
    planes: tuple[Plane, ...]
    kind: str


def read_listing(path: Path) -> dict[str, Entry]:
    """Reads the entries of a listing, by name.

    Raises:
        FileFormatError: if the file is not JSON or an entry is incomplete; the message names the line or the entry.
    """
    try:
        listing = json.loads(path.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise FileFormatError(f"{path}, line {error.lineno}: not JSON: {error.msg}") from error
    if not isinstance(listing, dict):
        raise FileFormatError(f"{path}: expected a JSON object with one entry per name, got {type(listing).__name__}")
    return {name: _entry(entry, f"{path}, entry {name!r}") for name, entry in listing.items()}


def _entry(entry: Any, where: str) -> Entry:
    if not isinstance(entry, dict) or not isinstance(entry.get("file"), str):
        raise FileFormatError(f'{where}: "file" is missing')
    if "planes" not in entry and "normal" not in entry:
        raise FileFormatError(f'{where}: "planes" or "normal" is missing; "normal": null means that there is no plane')
    planes = entry["planes"] if "planes" in entry else [entry] if entry["normal"] is not None else []
    kind = str(entry.get("kind", "")).split(":")[0].split(";")[0]
    return Entry(entry["file"], tuple(_plane(plane, where) for plane in planes), kind)


def _plane(plane: Any, where: str) -> Plane:
    try:
        normal, offset = np.array(plane["normal"], float), float(plane["offset"])
        length = float(np.linalg.norm(normal))
        if normal.shape != (3,) or not 0 < length < np.inf or not np.isfinite(offset):
            raise ValueError(plane)
    except (TypeError, KeyError, ValueError) as error:
        raise FileFormatError(
            f'{where}: a plane needs a nonzero "normal" of three finite numbers and a finite "offset"'
        ) from error
    return Plane(normal / length, np.asarray(offset / length))
