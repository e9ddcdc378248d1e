"""Binary glTF (.glb), what phones' scanners write, read by trimesh."""

import io
import struct
import warnings
from typing import Any

import numpy as np

from symjax.errors import FileFormatError
from symjax.io.mesh import Mesh

HEADER = struct.Struct("<4sII")


def read(data: bytes) -> Mesh:
    """Vertices and triangles of all meshes of the scene, each where the scene puts it, or the points of its clouds.

    Raises:
        FileFormatError: no GLB of version 2, not of the length that it claims, or damaged inside.
    """
    if len(data) < HEADER.size:
        raise FileFormatError("it is too short for a GLB header")
    magic, version, length = HEADER.unpack_from(data)
    if magic != b"glTF" or version != 2:
        raise FileFormatError("no GLB file of version 2: it does not start with 'glTF' and a 2")
    if length != len(data):
        raise FileFormatError(f"{length} bytes are promised, and the file has {len(data)}")
    import trimesh

    try:
        # no resolver: nothing outside the file is opened
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(data), file_type="glb", resolver=None, process=False)
            parts: list[Any] = list(scene.dump())
            vertices = [np.asarray(part.vertices, dtype=float).reshape(-1, 3) for part in parts]
            triangles = [np.asarray(getattr(part, "faces", ()), dtype=np.int64).reshape(-1, 3) for part in parts]
    # what trimesh raises of a damaged file is anybody's guess
    except Exception as error:
        raise FileFormatError(f"no readable GLB: {error or type(error).__name__}") from error
    if not parts:
        raise FileFormatError("a GLB without meshes or points")
    for part, corners in zip(vertices, triangles, strict=True):
        if len(corners) and not 0 <= corners.min() <= corners.max() < len(part):
            raise FileFormatError("a GLB with face corners that are no vertex")
    starts = np.cumsum([0, *map(len, vertices[:-1])])
    faces = np.concatenate([each + start for each, start in zip(triangles, starts, strict=True)])
    return Mesh(np.concatenate(vertices), faces, len(faces), len(parts))
