"""Small clouds and meshes, and minimal writers of every file format that symjax reads."""

import io

import numpy as np

from symjax.io.formats import obj_off_stl

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
PRISM = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 1], [2, 0, 1], [0, 2, 1]], dtype=float)
PRISM_FACES = [[0, 2, 1], [3, 4, 5], [0, 1, 4, 3], [1, 2, 5, 4], [2, 0, 3, 5]]
PLY_HEADER = "ply\nformat {}\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n"
FACE_HEADER = "element face {}\nproperty list uchar int vertex_indices\n"


def rows(array, mark=" "):
    return "".join(mark.join(map(repr, row)) + "\n" for row in np.asarray(array).tolist())


def polygons(faces):
    return "".join(f"{len(face)} {' '.join(map(str, face))}\n" for face in faces)


def ascii_ply(points, faces=()):
    header = PLY_HEADER.format("ascii 1.0", len(points), *["double"] * 3)
    header += FACE_HEADER.format(len(faces)) if len(faces) else ""
    return (header + "end_header\n" + rows(points) + polygons(faces)).encode()


def binary_ply(points, faces=(), order="<"):
    name = {"<": "binary_little_endian 1.0", ">": "binary_big_endian 1.0"}[order]
    header = PLY_HEADER.format(name, len(points), *["double"] * 3)
    header += FACE_HEADER.format(len(faces)) if len(faces) else ""
    body = b"".join(bytes([len(face)]) + np.array(face, order + "i4").tobytes() for face in faces)
    return (header + "end_header\n").encode() + np.asarray(points, order + "f8").tobytes() + body


def off(points, faces=()):
    return f"OFF\n{len(points)} {len(faces)} 0\n{rows(points)}{polygons(faces)}".encode()


def obj(points, faces=()):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points).tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    return ("\n".join(lines) + "\n").encode()


def binary_stl(triangles):
    table = np.zeros(len(triangles), obj_off_stl.STL_TRIANGLE)
    table["corners"] = triangles
    return b"solid or not".ljust(80) + np.uint32(len(table)).tobytes() + table.tobytes()


def ascii_stl(*solids):
    text = ""
    for triangles in solids:
        text += "solid part\n"
        for corners in np.asarray(triangles).tolist():
            vertices = "".join(f"  vertex {x!r} {y!r} {z!r}\n" for x, y, z in corners)
            text += f" facet normal 0 0 0\n outer loop\n{vertices} endloop\n endfacet\n"
        text += "endsolid part\n"
    return text.encode()


def npy(array, **options):
    stream = io.BytesIO()
    np.lib.format.write_array(stream, np.asarray(array), **options)
    return stream.getvalue()


CLOUDS = {
    "ascii.ply": ascii_ply,
    "little.ply": binary_ply,
    "big.PLY": lambda points: binary_ply(points, order=">"),
    "a.off": off,
    "a.obj": obj,
    "a.xyz": lambda points: rows(points).encode(),
    "a.txt": lambda points: rows(points, "\t").encode(),
    "a.csv": lambda points: rows(points, ",").encode(),
    "a.npy": npy,
}
MESHES = {
    "ascii.ply": ascii_ply,
    "little.ply": binary_ply,
    "big.ply": lambda points, faces: binary_ply(points, faces, ">"),
    "a.off": off,
    "a.obj": obj,
}


def put(folder, name, data):
    """Writes a new file and returns its path."""
    path = folder / name
    path.write_bytes(data)
    return path
