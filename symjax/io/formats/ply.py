"""The PLY format (Turk 1994), ASCII and binary. Each count of the header is checked against the body."""

import struct
from array import array
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import mesh, parsing

TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
BYTE_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
INDEX_NAMES = ("vertex_indices", "vertex_index")


class Property(NamedTuple):
    """A column of an element.

    Attributes:
        name: name of the property.
        type: NumPy type of its numbers, without byte order.
        length: NumPy type of the length of a list; empty for a single number.
    """

    name: str
    type: str
    length: str = ""


class Element(NamedTuple):
    """A table of the file: vertices, faces, or another one, which is ignored.

    Attributes:
        name: name of the element.
        num_rows: number of rows that the header declares.
        properties: columns, in order.
    """

    name: str
    num_rows: int
    properties: list[Property]

    @property
    def has_lists(self) -> bool:
        """Whether the element has a list property, so that its rows may differ in length."""
        return any(column.length for column in self.properties)

    def position(self, name: str) -> int:
        """Returns the column of a property.

        Raises:
            FileFormatError: if there is not exactly one property of this name.
        """
        names = [column.name for column in self.properties]
        if names.count(name) != 1:
            raise FileFormatError(
                f"the PLY header must declare one property {name!r} of element {parsing.shown(self.name)}, "
                f"and declares {names.count(name)}"
            )
        return names.index(name)


def read(data: bytes) -> mesh.Mesh:
    """Reads the vertices and faces of a PLY file.

    Raises:
        FileFormatError: if the file is not a PLY file, or its body does not match its header.
    """
    order, elements, start = _parse_header(data)
    body = memoryview(data)[start:]
    if order:
        vertices, faces = _read_binary(body, elements, order)
    else:
        rows = parsing.rows(bytes(body), first=len(parsing.lines(data[:start])))
        vertices, faces = _read_ascii(rows, elements)
    return mesh.from_polygons(vertices, faces)


def _parse_header(data: bytes) -> tuple[str, list[Element], int]:
    """Returns the byte order (empty for ASCII), the elements, and the offset of the body."""
    if data[:3] != b"ply" or data[3:4] not in (b"\n", b"\r"):
        raise FileFormatError("it is not a PLY file: it does not start with 'ply'")
    end = data.find(b"end_header")
    start = end + len(b"end_header")
    start += 2 if data[start : start + 2] == b"\r\n" else 1
    if end < 0 or start > len(data):
        raise FileFormatError("the PLY header has no line 'end_header': the file is truncated or damaged")
    order: str | None = None
    elements: list[Element] = []
    for number, line in enumerate(parsing.lines(data[3:end]), start=1):
        match line.split():
            case [] | ["comment" | "obj_info", *_]:
                pass
            case ["format", name, "1.0"] if name in BYTE_ORDERS:
                order = BYTE_ORDERS[name]
            case ["element", name, count] if count.isdecimal() and len(count) < 19:
                elements.append(Element(name, int(count), []))
            case ["property", type_, name] if elements and type_ in TYPES:
                elements[-1].properties.append(Property(name, TYPES[type_]))
            case ["property", "list", length, type_, name] if elements and {length, type_} <= TYPES.keys():
                elements[-1].properties.append(Property(name, TYPES[type_], TYPES[length]))
            case _:
                raise FileFormatError(f"line {number}: invalid line in the PLY header: {parsing.shown(line)}")
    if order is None:
        raise FileFormatError("the PLY header has no line 'format'")
    _check_elements(elements)
    return order, elements, start


def _check_elements(elements: list[Element]) -> None:
    names = [element.name for element in elements]
    if names.count("vertex") != 1 or names.count("face") > 1:
        raise FileFormatError(
            "the PLY header must declare one element 'vertex' and at most one 'face', "
            f"and declares {names.count('vertex')} and {names.count('face')}"
        )
    vertex = elements[names.index("vertex")]
    if vertex.has_lists:
        raise FileFormatError("the PLY header declares a list property of the vertices, which is not supported")
    for axis in "xyz":
        vertex.position(axis)
    for element in elements:
        if any(column.length.startswith("f") for column in element.properties):
            raise FileFormatError(
                f"the PLY header declares a list of element {parsing.shown(element.name)} "
                "whose length is not an integer"
            )
    if "face" in names:
        _index_column(elements[names.index("face")])


def _index_column(element: Element) -> int:
    """Returns the column of the faces with the list of their vertices."""
    columns = [i for i, column in enumerate(element.properties) if column.name in INDEX_NAMES and column.length]
    if len(columns) != 1 or element.properties[columns[0]].type.startswith("f"):
        raise FileFormatError("the PLY header must declare one list 'vertex_indices' of integers for the faces")
    return columns[0]


def _read_ascii(rows: parsing.Rows, elements: list[Element]) -> tuple[Float[np.ndarray, "v 3"], mesh.Polygons]:
    elements = [element for element in elements if element.properties]
    expected = sum(element.num_rows for element in elements)
    if len(rows) != expected:
        raise FileFormatError(
            f"expected {expected} rows as the PLY header declares, found {len(rows)}: the file is truncated or damaged"
        )
    vertices, faces = np.empty((0, 3)), mesh.NO_POLYGONS
    start = 0
    for element in elements:
        part = rows[start : start + element.num_rows]
        start += element.num_rows
        if element.name == "vertex":
            columns = parsing.parse(part, range(len(element.properties)))
            vertices = columns[:, [element.position(axis) for axis in "xyz"]]
        elif element.name == "face":
            index = _index_column(element)
            if any(column.length for column in element.properties[:index]):
                raise FileFormatError(
                    "the PLY header declares a list before 'vertex_indices' for the faces, which is not supported"
                )
            faces = mesh.parse_polygons(part, skip=index)
    return vertices, faces


def _read_binary(
    body: memoryview, elements: list[Element], order: str
) -> tuple[Float[np.ndarray, "v 3"], mesh.Polygons]:
    vertices, faces = np.empty((0, 3)), mesh.NO_POLYGONS
    for element in elements:
        index = _index_column(element) if element.name == "face" else None
        if element.has_lists and element.num_rows:
            size, found = _read_lists(body, element, order, index)
            faces = found if element.name == "face" else faces
        else:
            dtype = _row_type(element, order, [])
            size = element.num_rows * dtype.itemsize
            _check_size(body, element, size)
            if element.name == "vertex":
                # by position, since a faulty header may declare a name twice
                rows = np.frombuffer(body[:size], dtype)
                vertices = np.stack([rows[f"f{element.position(axis)}"].astype(np.float64) for axis in "xyz"], axis=1)
        body = body[size:]
    if len(body):
        raise FileFormatError(
            f"{len(body)} bytes follow the last row that the PLY header declares: the file is damaged"
        )
    return vertices, faces


def _check_size(body: memoryview, element: Element, size: int) -> None:
    if size > len(body):
        raise FileFormatError(
            f"expected {element.num_rows} rows of {parsing.shown(element.name)} with {size} bytes or more as the PLY "
            f"header declares, found {len(body)} bytes: the file is truncated or damaged"
        )


def _row_type(element: Element, order: str, sizes: list[int]) -> np.dtype:
    """Returns the type of a row whose lists have the given lengths; a list is two fields, length and numbers."""
    fields: list[tuple[str, str] | tuple[str, str, tuple[int]]] = []
    remaining = iter(sizes)
    for position, column in enumerate(element.properties):
        if column.length:
            fields.append((f"n{position}", order + column.length))
            fields.append((f"f{position}", order + column.type, (next(remaining),)))
        else:
            fields.append((f"f{position}", order + column.type))
    return np.dtype(fields)


def _read_lists(body: memoryview, element: Element, order: str, index: int | None) -> tuple[int, mesh.Polygons]:
    """Reads an element with lists: all rows at once if their lists have the same lengths, otherwise row by row.

    Returns:
        Size of the element in bytes, and the polygons in column `index`.
    """
    end, sizes, _ = _walk(body, element, order, index, 1)
    dtype = _row_type(element, order, sizes)
    size = element.num_rows * end
    if size <= len(body):
        rows = np.frombuffer(body[:size], dtype)
        lists = [i for i, column in enumerate(element.properties) if column.length]
        if all((rows[f"n{i}"] == length).all() for i, length in zip(lists, sizes, strict=True)):
            if index is None:
                return size, mesh.NO_POLYGONS
            corners = rows[f"f{index}"].astype(np.int64)
            return size, mesh.Polygons(np.full(element.num_rows, corners.shape[1]), corners.ravel())
    end, _, faces = _walk(body, element, order, index, element.num_rows)
    return end, faces


def _walk(
    body: memoryview, element: Element, order: str, index: int | None, count: int
) -> tuple[int, list[int], mesh.Polygons]:
    """Reads the first `count` rows of an element.

    Returns:
        Size of the rows in bytes, lengths of the lists in the last row, and the polygons in column `index`.
    """
    columns = [
        (struct.Struct(order + _code(column.length)) if column.length else None, _code(column.type))
        for column in element.properties
    ]
    sizes, corners = array("q"), array("q")
    lengths: list[int] = []
    at = 0
    for _ in range(count):
        lengths = []
        for position, (counter, code) in enumerate(columns):
            length = 1
            if counter:
                _check_size(body, element, at + counter.size)
                (length,) = counter.unpack_from(body, at)
                at += counter.size
                lengths.append(length)
            end = at + length * struct.calcsize("=" + code)
            if length < 0 or end > len(body):
                raise FileFormatError(
                    f"a list of {length} numbers in element {parsing.shown(element.name)} extends beyond the end of "
                    "the file: the file is truncated or damaged"
                )
            if position == index:
                sizes.append(length)
                corners.extend(struct.unpack_from(f"{order}{length}{code}", body, at))
            at = end
    return at, lengths, mesh.Polygons(np.array(sizes, np.int64), np.array(corners, np.int64))


def _code(type_: str) -> str:
    """Returns the format character of the struct module for a type."""
    return {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}[type_]
