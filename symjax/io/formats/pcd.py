"""The PCD format of the Point Cloud Library (version 0.7): ascii, binary and binary_compressed."""

import struct
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing

TYPES = {
    ("F", 4): "<f4",
    ("F", 8): "<f8",
    **{("I", size): f"<i{size}" for size in (1, 2, 4, 8)},
    **{("U", size): f"<u{size}" for size in (1, 2, 4, 8)},
}
MAX_LZF_RATIO = 88
"""The longest LZF back reference: 264 bytes from 3."""


class Field(NamedTuple):
    """A column of a point: its name, numpy type, numbers in it, and what comes before it in a point."""

    name: str
    type: str
    num: int
    first_byte: int
    first_number: int

    @property
    def size(self) -> int:
        """Bytes that it takes in a point."""
        return self.num * np.dtype(self.type).itemsize


class Header(NamedTuple):
    """What the header declares, and where the body starts."""

    fields: list[Field]
    num_points: int
    encoding: str
    start: int

    @property
    def axes(self) -> list[Field]:
        """The fields x, y and z."""
        named = {field.name: field for field in self.fields if field.num == 1}
        if not {"x", "y", "z"} <= named.keys():
            raise FileFormatError("the PCD header declares no fields x, y and z")
        return [named[axis] for axis in "xyz"]

    @property
    def point_size(self) -> int:
        """Bytes of a point."""
        return sum(field.size for field in self.fields)


def read(data: bytes) -> tuple[Float[np.ndarray, "n 3"], str]:
    """Points, and a note on those left out: NaN marks a pixel without a point in an organised cloud.

    Raises:
        FileFormatError: no PCD, or its body is not what its header says.
    """
    header = _parse_header(data)
    body = data[header.start :]
    if header.encoding == "ascii":
        points = _read_ascii(body, header)
    elif header.encoding == "binary":
        points = _read_binary(body, header)
    else:
        points = _read_compressed(body, header)
    missing = np.isnan(points).any(axis=1)
    if not missing.any():
        return points, ""
    return points[~missing], f"{missing.sum()} of {len(points)} points are NaN (no measurement) and were left out"


def _parse_header(data: bytes) -> Header:
    """The header ends with the line that starts with DATA."""
    values: dict[str, list[str]] = {}
    start = 0
    while "DATA" not in values:
        end = data.find(b"\n", start)
        if end < 0:
            raise FileFormatError("no PCD file, or a truncated one: its header has no line 'DATA' with its end")
        key, *cells = data[start:end].decode("latin-1").split("#", 1)[0].split() or [""]
        start = end + 1
        if key not in (
            "",
            "VERSION",
            "FIELDS",
            "SIZE",
            "TYPE",
            "COUNT",
            "WIDTH",
            "HEIGHT",
            "VIEWPOINT",
            "POINTS",
            "DATA",
        ):
            raise FileFormatError(f"no PCD file: its header has a line that starts with {parsing.shown(key)}")
        values[key] = cells
    encoding = " ".join(values["DATA"])
    if encoding not in ("ascii", "binary", "binary_compressed"):
        raise FileFormatError(f"DATA {parsing.shown(encoding)} is not one of ascii, binary, binary_compressed")
    width, height = _number(values, "WIDTH"), _number(values, "HEIGHT")
    if "POINTS" in values and _number(values, "POINTS") != width * height:
        raise FileFormatError(f"the header promises {width} x {height} points and POINTS says otherwise")
    return Header(_fields(values), width * height, encoding, start)


def _number(values: dict[str, list[str]], key: str) -> int:
    match values.get(key):
        case [cell] if cell.isdecimal() and len(cell) < 19:
            return int(cell)
    raise FileFormatError(f"the PCD header gives no single count after {key}")


def _fields(values: dict[str, list[str]]) -> list[Field]:
    names = values.get("FIELDS", [])
    rows = [values.get("SIZE", []), values.get("TYPE", []), values.get("COUNT", ["1"] * len(names))]
    if any(len(row) != len(names) for row in rows):
        raise FileFormatError("FIELDS, SIZE, TYPE and COUNT of the PCD header differ in length")
    fields: list[Field] = []
    byte = number = 0
    for name, size, type_, count in zip(names, *rows, strict=True):
        if not (size.isdecimal() and count.isdecimal() and len(size) + len(count) < 9 and (type_, int(size)) in TYPES):
            raise FileFormatError(f"field {parsing.shown(name)} of the PCD header is of no known type")
        fields.append(Field(name, TYPES[type_, int(size)], int(count), byte, number))
        byte += fields[-1].size
        number += int(count)
    return fields


def _read_ascii(body: bytes, header: Header) -> Float[np.ndarray, "n 3"]:
    rows = [row for row in parsing.lines(body) if row.strip()]
    if len(rows) != header.num_points:
        raise FileFormatError(f"the header promises {header.num_points} points, the file holds {len(rows)} rows")
    size = sum(field.num for field in header.fields)
    for number, row in enumerate(rows, start=1):
        if len(row.split()) != size:
            raise FileFormatError(f"row {number} of its data is {parsing.shown(row)}: {size} numbers expected")
    return parsing.parse(rows, [field.first_number for field in header.axes])


def _read_binary(body: bytes, header: Header) -> Float[np.ndarray, "n 3"]:
    """Point after point."""
    size = header.num_points * header.point_size
    # some writers pad the body with zeros to a whole memory page
    if len(body) < size or body[size:].strip(b"\0"):
        raise FileFormatError(f"the header promises {size} bytes of points, the file holds {len(body)}")
    axes = header.axes
    row = np.dtype(
        {
            "names": ["x", "y", "z"],
            "formats": [field.type for field in axes],
            "offsets": [field.first_byte for field in axes],
            "itemsize": header.point_size,
        }
    )
    points = np.frombuffer(body[:size], row)
    return np.stack([points[axis].astype(np.float64) for axis in "xyz"], axis=1)


def _read_compressed(body: bytes, header: Header) -> Float[np.ndarray, "n 3"]:
    """Field after field, packed by LZF behind two sizes."""
    size = header.num_points * header.point_size
    packed, unpacked = struct.unpack("<II", body[:8]) if len(body) >= 8 else (0, 0)
    if packed > len(body) - 8 or body[8 + packed :].strip(b"\0"):
        raise FileFormatError(f"{packed} compressed bytes are promised, the file holds {len(body)}")
    if unpacked != size:
        raise FileFormatError(f"the header promises {size} bytes of points, the compressed block {unpacked}")
    columns = decompress(body[8 : 8 + packed], unpacked)
    starts = {field.name: header.num_points * field.first_byte for field in header.fields}
    return np.stack(
        [
            np.frombuffer(columns, field.type, header.num_points, starts[field.name]).astype(np.float64)
            for field in header.axes
        ],
        axis=1,
    )


def decompress(packed: bytes, size: int) -> bytes:
    """Undo LZF, Marc Lehmann's compression: literal runs, and references back into what was written.

    Args:
        packed: the compressed bytes.
        size: how many bytes they must give.

    Raises:
        FileFormatError: they do not.
    """
    if size > MAX_LZF_RATIO * len(packed):
        raise FileFormatError(f"{len(packed)} compressed bytes cannot hold {size}")
    out = bytearray()
    at, end = 0, len(packed)
    try:
        while at < end and len(out) <= size:
            control = packed[at]
            at += 1
            if control < 32:
                out += packed[at : at + control + 1]
                at += control + 1
                continue
            length = (control >> 5) + 2
            if length == 9:
                length += packed[at]
                at += 1
            start = len(out) - ((control & 31) << 8) - packed[at] - 1
            at += 1
            if start < 0:
                raise FileFormatError("the compressed block refers to bytes before its start")
            piece = out[start : start + length]
            # a reference may run into the bytes that it is writing: the piece then repeats
            out += piece if len(piece) == length else (piece * (length // len(piece) + 1))[:length]
    except IndexError:
        raise FileFormatError("the compressed block is truncated") from None
    if at != end or len(out) != size:
        raise FileFormatError(f"the compressed block holds {len(out)} bytes where {size} were promised")
    return bytes(out)
