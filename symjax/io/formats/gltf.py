"""Binary glTF (.glb), the format of scanning apps on phones, read by trimesh."""

import io
import struct
import warnings
from typing import Any

import numpy as np

from symjax.errors import FileFormatError
from symjax.io.mesh import Mesh

HEADER = struct.Struct("<4sII")


def read(data: bytes) -> Mesh:
    """Reads all meshes and point clouds of a scene, at the positions that the scene gives them.

    Raises:
        FileFormatError: if the file is not GLB version 2, has another length than its header declares, or is damaged.
    """
    if len(data) < HEADER.size:
        raise FileFormatError(f"it has {len(data)} bytes, fewer than the {HEADER.size} of a GLB header")
    magic, version, length = HEADER.unpack_from(data)
    if magic != b"glTF" or version != 2:
        raise FileFormatError("it is not a GLB file of version 2: it does not start with 'glTF' and the number 2")
    if length != len(data):
        raise FileFormatError(
            f"expected {length} bytes as the GLB header declares, found {len(data)}: the file is truncated or damaged"
        )
    import trimesh

    try:
        # without a resolver, trimesh opens no other file
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(data), file_type="glb", resolver=None, process=False)
            parts: list[Any] = list(scene.dump())
            vertices = [np.asarray(part.vertices, dtype=float).reshape(-1, 3) for part in parts]
            triangles = [np.asarray(getattr(part, "faces", ()), dtype=np.int64).reshape(-1, 3) for part in parts]
    # for a damaged file, trimesh can raise anything
    except Exception as error:
        raise FileFormatError(f"the GLB is damaged: {error or type(error).__name__}") from error
    if not parts:
        raise FileFormatError("the GLB contains no meshes and no points")
    for part, corners in zip(vertices, triangles, strict=True):
        if len(corners) and not 0 <= corners.min() <= corners.max() < len(part):
            raise FileFormatError(f"a face of the GLB refers to a vertex outside the {len(part)} vertices of its mesh")
    starts = np.cumsum([0, *map(len, vertices[:-1])])
    faces = np.concatenate([each + start for each, start in zip(triangles, starts, strict=True)])
    return Mesh(np.concatenate(vertices), faces, len(faces), len(parts))
