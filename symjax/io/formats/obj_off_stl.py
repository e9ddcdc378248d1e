"""The mesh formats OBJ, OFF and STL, read strictly.

General mesh libraries forgive: of a truncated OFF or STL they return the faces that are left, and a face of an OBJ
that counts its vertices backwards (−1 is the newest) gets wrong ones. Here such a file is read right or not at all.
"""

import re
from array import array

import numpy as np

from symjax.errors import FileFormatError
from symjax.io import mesh, parsing

STL_HEADER = 80
STL_TRIANGLE = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_obj(data: bytes) -> mesh.Mesh:
    """Vertices and faces of a Wavefront OBJ; its objects and groups are merged, materials and textures ignored."""
    rows: list[str] = []
    sizes, corners = array("q"), array("q")
    part, parts = 0, set()
    for line in parsing.lines(data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")):
        keyword, *cells = line.split("#", 1)[0].split() or [""]
        if keyword == "v":
            rows.append(" ".join(cells))
        elif keyword == "f":
            corners.extend(_obj_corner(cell, len(rows), line) for cell in cells)
            sizes.append(len(cells))
            parts.add(part)
        elif keyword in ("o", "g"):
            part += 1
    if not rows:
        raise FileFormatError("no OBJ with vertices: no line starts with 'v'")
    polygons = mesh.Polygons(np.array(sizes, np.int64), np.array(corners, np.int64))
    return mesh.from_polygons(parsing.parse(rows, (0, 1, 2)), polygons, max(len(parts), 1))


def _obj_corner(cell: str, num_vertices: int, line: str) -> int:
    """Vertex of a corner "vertex/texture/normal": counted from 1, or backwards from the newest if negative."""
    try:
        index = int(cell.split("/", 1)[0])
    except ValueError:
        index = 0
    if index == 0 or abs(index) >= 2**62:
        raise FileFormatError(f"face {parsing.shown(line)} is not understood")
    return index - 1 if index > 0 else index + num_vertices


def read_off(data: bytes) -> mesh.Mesh:
    """Vertices and faces of an ascii OFF, with or without colours, normals and texture coordinates."""
    rows = [row for line in parsing.lines(data) if (row := line.split("#", 1)[0].strip())]
    match = re.match(r"(ST)?C?N?OFF", rows[0]) if rows else None
    if match is None:
        raise FileFormatError("no OFF file: it does not start with 'OFF'")
    # the counts may follow on the same line, even without a space
    rows[0] = rows[0][match.end() :].strip()
    rows = rows[0 if rows[0] else 1 :]
    counts = re.fullmatch(r"(\d{1,18})\s+(\d{1,18})(\s+\d+)?", rows[0], re.ASCII) if rows else None
    if counts is None:
        raise FileFormatError("the OFF header holds no counts of vertices, faces and edges")
    num_vertices, num_faces = int(counts[1]), int(counts[2])
    if len(rows) - 1 != num_vertices + num_faces:
        raise FileFormatError(
            f"the header promises {num_vertices} vertices and {num_faces} faces, the file holds {len(rows) - 1} rows"
        )
    vertices = parsing.parse(rows[1 : 1 + num_vertices], (0, 1, 2))
    return mesh.from_polygons(vertices, mesh.parse_polygons(rows[1 + num_vertices :]))


def read_stl(data: bytes) -> mesh.Mesh:
    """Triangles of an STL, binary or ascii; several solids are merged."""
    body = data[STL_HEADER + 4 :]
    promised = int.from_bytes(data[STL_HEADER : STL_HEADER + 4], "little")
    if len(data) >= STL_HEADER + 4 and len(body) == promised * STL_TRIANGLE.itemsize:
        corners = np.frombuffer(body, STL_TRIANGLE)["corners"].astype(np.float64)
        return _triangle_soup(corners.reshape(-1, 3), 1)
    if not data[:STL_HEADER].lstrip().lower().startswith(b"solid"):
        raise FileFormatError(
            f"no STL file: not text, and not the {promised} triangles that a binary header would promise"
        )
    return _read_ascii_stl(data)


def _read_ascii_stl(data: bytes) -> mesh.Mesh:
    rows = [row for line in parsing.lines(data) if (row := line.strip().lower())]
    first_words = [row.split(None, 1)[0] for row in rows]
    num = {word: first_words.count(word) for word in ("solid", "endsolid", "facet", "endfacet", "vertex")}
    closed = num["solid"] == num["endsolid"] and num["facet"] == num["endfacet"]
    if not closed or num["vertex"] != 3 * num["facet"] or first_words[-1] != "endsolid":
        raise FileFormatError(
            f"truncated STL: {num['solid']} solids begin and {num['endsolid']} end, "
            f"{num['facet']} facets begin and {num['endfacet']} end, with {num['vertex']} vertices"
        )
    corners = [row for row, word in zip(rows, first_words, strict=True) if word == "vertex"]
    return _triangle_soup(parsing.parse(corners, (1, 2, 3)), num["solid"])


def _triangle_soup(corners: np.ndarray, num_parts: int) -> mesh.Mesh:
    triangles = np.arange(len(corners)).reshape(-1, 3)
    return mesh.Mesh(corners, triangles, len(triangles), num_parts)
