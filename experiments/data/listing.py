"""A `planes.json`: the objects of a folder and their planes.

```json
{"boat": {"file": "models/boat.obj", "normal": [1, 0, 0], "offset": -3.25, "kind": "exact"},
 "box": {"file": "box.ply", "planes": [{"normal": [1, 0, 0], "offset": 0}, {"normal": [0, 1, 0], "offset": 0}]},
 "stone": {"file": "stone.stl", "normal": null, "kind": "none"}}
```

normal · x = offset, in the units and the frame of the file; `kind` becomes the group, up to a colon or a semicolon.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from symjax.errors import FileFormatError
from symjax.geometry.plane import Plane

LISTING = "planes.json"


class Entry(NamedTuple):
    """What the listing says of an object."""

    file: str
    planes: tuple[Plane, ...]
    kind: str


def read_listing(path: Path) -> dict[str, Entry]:
    """The entries of a listing by name.

    Raises:
        FileFormatError: it is no JSON, or an entry lacks something; file and line, or entry, are named.
    """
    try:
        listing = json.loads(path.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise FileFormatError(f"{path}, line {error.lineno}: no JSON: {error.msg}") from error
    if not isinstance(listing, dict):
        raise FileFormatError(f"{path}: an object of entries by name expected")
    return {name: _entry(entry, f"{path}, entry {name!r}") for name, entry in listing.items()}


def _entry(entry: Any, where: str) -> Entry:
    if not isinstance(entry, dict) or not isinstance(entry.get("file"), str):
        raise FileFormatError(f'{where}: no "file"')
    if "planes" not in entry and "normal" not in entry:
        raise FileFormatError(f'{where}: neither "planes" nor "normal"; null says that it has none')
    given = entry["planes"] if "planes" in entry else [entry] if entry["normal"] is not None else []
    kind = str(entry.get("kind", "")).split(":")[0].split(";")[0]
    return Entry(entry["file"], tuple(_plane(one, where) for one in given), kind)


def _plane(given: Any, where: str) -> Plane:
    try:
        normal, offset = np.array(given["normal"], float), float(given["offset"])
        length = float(np.linalg.norm(normal))
        if normal.shape != (3,) or not 0 < length < np.inf or not np.isfinite(offset):
            raise ValueError(given)
    except (TypeError, KeyError, ValueError) as error:
        raise FileFormatError(f'{where}: a plane needs a "normal" of three numbers, not 0, and an "offset"') from error
    return Plane(normal / length, np.asarray(offset / length))
