"""Strict readers of the mesh formats OBJ, OFF and STL.

General mesh libraries are lenient: they return the remaining faces of a truncated OFF or STL, and wrong vertices for a
face of an OBJ with relative indices (−1 is the latest vertex). These readers read such a file correctly or not at all.
"""

import re
from array import array
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import mesh, parsing

STL_HEADER = 80
STL_TRIANGLE = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_obj(data: bytes) -> mesh.Mesh:
    """Reads the vertices and faces of a Wavefront OBJ. Objects and groups are merged; materials are ignored.

    Raises:
        FileFormatError: if the file has no vertices, or is damaged.
    """
    rows = parsing.Rows([], [])
    sizes, corners = array("q"), array("q")
    part, parts = 0, set()
    for number, line in _continued_lines(data):
        keyword, *cells = line.split("#", 1)[0].split() or [""]
        if keyword == "v":
            rows.texts.append(" ".join([keyword, *cells]))
            rows.numbers.append(number)
        elif keyword == "f":
            corners.extend(_obj_corner(cell, len(rows), number) for cell in cells)
            sizes.append(len(cells))
            parts.add(part)
        elif keyword in ("o", "g"):
            part += 1
    if not len(rows):
        raise FileFormatError("it is not an OBJ file with vertices: no line starts with 'v'")
    polygons = mesh.Polygons(np.array(sizes, np.int64), np.array(corners, np.int64))
    vertices = parsing.parse(rows, (1, 2, 3))
    return mesh.from_polygons(vertices, polygons, num_parts=max(len(parts), 1), first_index=1)


def _continued_lines(data: bytes) -> Iterator[tuple[int, str]]:
    """Yields each line and its number; a line that ends with a backslash continues on the next line."""
    lines = enumerate(parsing.lines(data), start=1)
    for number, line in lines:
        while line.endswith("\\") and (following := next(lines, None)):
            line = line[:-1] + " " + following[1]
        yield number, line


def _obj_corner(cell: str, num_vertices: int, line: int) -> int:
    """Returns the vertex of a corner "vertex/texture/normal", counted from 0.

    In the file, vertices are counted from 1, or backwards from the latest vertex if the index is negative.
    """
    try:
        index = int(cell.split("/", 1)[0])
    except ValueError:
        index = 0
    if index == 0 or abs(index) >= 2**62:
        raise FileFormatError(f"line {line}: expected a vertex index other than 0, found {parsing.shown(cell)}")
    if index < -num_vertices:
        raise FileFormatError(
            f"line {line}: vertex index {index}, but the number of vertices before the face is {num_vertices}"
        )
    return index - 1 if index > 0 else index + num_vertices


def read_off(data: bytes) -> mesh.Mesh:
    """Reads the vertices and faces of an ASCII OFF, with or without colours, normals and texture coordinates.

    Raises:
        FileFormatError: if the file is not an OFF file, or is damaged.
    """
    rows = parsing.rows(data, clean=lambda line: line.split("#", 1)[0].strip())
    match = re.match(r"(ST)?C?N?OFF", rows.texts[0]) if len(rows) else None
    if match is None:
        raise FileFormatError("it is not an OFF file: it does not start with 'OFF'")
    # the counts may follow on the same line, even without a space
    rows.texts[0] = rows.texts[0][match.end() :].strip()
    rows = rows if rows.texts[0] else rows[1:]
    if not len(rows):
        raise FileFormatError("it ends after 'OFF', before the numbers of vertices and faces")
    counts = re.fullmatch(r"(\d{1,18})\s+(\d{1,18})(\s+\d+)?", rows.texts[0], re.ASCII)
    if counts is None:
        raise FileFormatError(
            f"line {rows.numbers[0]}: expected the numbers of vertices, faces and edges, "
            f"found {parsing.shown(rows.texts[0])}"
        )
    num_vertices, num_faces = int(counts[1]), int(counts[2])
    if len(rows) - 1 != num_vertices + num_faces:
        raise FileFormatError(
            f"expected {num_vertices} + {num_faces} rows of vertices and faces as the OFF header declares, "
            f"found {len(rows) - 1}: "
            "the file is truncated or damaged"
        )
    vertices = parsing.parse(rows[1 : 1 + num_vertices], (0, 1, 2))
    return mesh.from_polygons(vertices, mesh.parse_polygons(rows[1 + num_vertices :]))


def read_stl(data: bytes) -> mesh.Mesh:
    """Reads the triangles of an STL, binary or ASCII. Several solids are merged.

    Raises:
        FileFormatError: if the file is not an STL file, or is truncated.
    """
    body = data[STL_HEADER + 4 :]
    declared = int.from_bytes(data[STL_HEADER : STL_HEADER + 4], "little")
    if len(data) >= STL_HEADER + 4 and len(body) == declared * STL_TRIANGLE.itemsize:
        corners = np.frombuffer(body, STL_TRIANGLE)["corners"].astype(np.float64)
        return _triangle_soup(corners.reshape(-1, 3), 1)
    if not data[:STL_HEADER].lstrip().lower().startswith(b"solid"):
        raise FileFormatError(
            "it is not an STL file, or it is truncated: it does not start with 'solid', and its size is not that of "
            f"the {declared} triangles that a binary header would declare"
        )
    return _read_ascii_stl(data)


def _read_ascii_stl(data: bytes) -> mesh.Mesh:
    rows = parsing.rows(data, clean=lambda line: line.strip().lower())
    first_words = [row.split(None, 1)[0] for row in rows.texts]
    num = {word: first_words.count(word) for word in ("solid", "endsolid", "facet", "endfacet", "vertex")}
    closed = num["solid"] == num["endsolid"] and num["facet"] == num["endfacet"]
    if not closed or num["vertex"] != 3 * num["facet"] or first_words[-1] != "endsolid":
        raise FileFormatError(
            f"the STL is truncated or damaged: {num['solid']} solids begin and {num['endsolid']} end, "
            f"{num['facet']} facets begin and {num['endfacet']} end, with {num['vertex']} vertices"
        )
    vertices = [index for index, word in enumerate(first_words) if word == "vertex"]
    corners = parsing.Rows([rows.texts[i] for i in vertices], [rows.numbers[i] for i in vertices])
    return _triangle_soup(parsing.parse(corners, (1, 2, 3)), num["solid"])


def _triangle_soup(corners: Float[np.ndarray, "c 3"], num_parts: int) -> mesh.Mesh:
    triangles = np.arange(len(corners)).reshape(-1, 3)
    return mesh.Mesh(corners, triangles, len(triangles), num_parts)
