"""The PCD format of the Point Cloud Library, version 0.7: ascii, binary and binary_compressed."""

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
KEYS = ("VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA")
MAX_LZF_RATIO = 88
"""Ratio of the longest LZF back reference, 264 bytes from 3."""


class Field(NamedTuple):
    """A field of the points.

    Attributes:
        name: name of the field.
        type: NumPy type of its numbers.
        num: how many numbers it has.
        first_byte: offset of the field in a point, in bytes.
        first_number: offset of the field in a point, in numbers.
    """

    name: str
    type: str
    num: int
    first_byte: int
    first_number: int

    @property
    def size(self) -> int:
        """Size of the field in a point, in bytes."""
        return self.num * np.dtype(self.type).itemsize


class Header(NamedTuple):
    """Header of a PCD file.

    Attributes:
        fields: fields of each point, in order.
        num_points: number of points.
        encoding: "ascii", "binary" or "binary_compressed".
        start: offset of the body in the file, in bytes.
        num_lines: number of lines of the header.
    """

    fields: list[Field]
    num_points: int
    encoding: str
    start: int
    num_lines: int

    @property
    def axes(self) -> list[Field]:
        """The fields x, y and z."""
        named = {field.name: field for field in self.fields if field.num == 1}
        if not {"x", "y", "z"} <= named.keys():
            raise FileFormatError("the PCD header must declare fields x, y and z with one number each")
        return [named[axis] for axis in "xyz"]

    @property
    def point_size(self) -> int:
        """Size of a point in bytes."""
        return sum(field.size for field in self.fields)


def read(data: bytes) -> tuple[Float[np.ndarray, "n 3"], str]:
    """Reads the points of a PCD file.

    Points with NaN coordinates are removed: they mark pixels without a measurement in an organised cloud.

    Returns:
        The points, and a note on the removed ones.

    Raises:
        FileFormatError: if the file is not a PCD file, or its body does not match its header.
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
    return points[~missing], f"{missing.sum()} of {len(points)} points are NaN (no measurement) and were removed"


def _parse_header(data: bytes) -> Header:
    """Parses the header, which ends with the line that starts with DATA."""
    values: dict[str, list[str]] = {}
    start = num_lines = 0
    while "DATA" not in values:
        end = data.find(b"\n", start)
        if end < 0:
            raise FileFormatError("it is not a PCD file, or it is truncated: the header has no complete line 'DATA'")
        key, *cells = data[start:end].decode("latin-1").split("#", 1)[0].split() or [""]
        start, num_lines = end + 1, num_lines + 1
        if key not in ("", *KEYS):
            raise FileFormatError(
                f"line {num_lines}: a line of a PCD header cannot start with {parsing.shown(key)}, only with "
                f"{', '.join(KEYS)}"
            )
        values[key] = cells
    encoding = " ".join(values["DATA"])
    if encoding not in ("ascii", "binary", "binary_compressed"):
        raise FileFormatError(
            f"line {num_lines}: DATA must be ascii, binary or binary_compressed, got {parsing.shown(encoding)}"
        )
    width, height = _number(values, "WIDTH"), _number(values, "HEIGHT")
    if "POINTS" in values and (points := _number(values, "POINTS")) != width * height:
        raise FileFormatError(f"the PCD header declares {points} POINTS, but WIDTH x HEIGHT is {width} x {height}")
    return Header(_fields(values), width * height, encoding, start, num_lines)


def _number(values: dict[str, list[str]], key: str) -> int:
    match values.get(key):
        case [cell] if cell.isdecimal() and len(cell) < 19:
            return int(cell)
    raise FileFormatError(f"the PCD header must have a line '{key}' with one whole number")


def _fields(values: dict[str, list[str]]) -> list[Field]:
    names = values.get("FIELDS", [])
    rows = [values.get("SIZE", []), values.get("TYPE", []), values.get("COUNT", ["1"] * len(names))]
    if any(len(row) != len(names) for row in rows):
        raise FileFormatError(
            "FIELDS, SIZE, TYPE and COUNT of the PCD header must have the same number of entries, got "
            + ", ".join(str(len(row)) for row in (names, *rows))
        )
    fields: list[Field] = []
    byte = number = 0
    for name, size, type_, count in zip(names, *rows, strict=True):
        if not (size.isdecimal() and count.isdecimal() and len(size) + len(count) < 9 and (type_, int(size)) in TYPES):
            raise FileFormatError(
                f"field {parsing.shown(name)} of the PCD header has an invalid type: "
                f"TYPE {parsing.shown(type_)}, SIZE {parsing.shown(size)}, COUNT {parsing.shown(count)}"
            )
        fields.append(Field(name, TYPES[type_, int(size)], int(count), byte, number))
        byte += fields[-1].size
        number += int(count)
    return fields


def _read_ascii(body: bytes, header: Header) -> Float[np.ndarray, "n 3"]:
    rows = parsing.rows(body, first=header.num_lines + 1)
    if len(rows) != header.num_points:
        raise FileFormatError(
            f"expected {header.num_points} points as the PCD header declares, found {len(rows)} rows: "
            "the file is truncated or damaged"
        )
    size = sum(field.num for field in header.fields)
    for row, number in zip(rows.texts, rows.numbers, strict=True):
        if (count := len(row.split())) != size:
            raise FileFormatError(f"line {number}: expected {size} numbers, found {count} in {parsing.shown(row)}")
    return parsing.parse(rows, [field.first_number for field in header.axes])


def _read_binary(body: bytes, header: Header) -> Float[np.ndarray, "n 3"]:
    """Reads a body in which the points follow each other."""
    size = header.num_points * header.point_size
    # some writers pad the body with zeros to a whole memory page
    if len(body) < size or body[size:].strip(b"\0"):
        raise FileFormatError(
            f"expected {size} bytes of points as the PCD header declares, found {len(body)}: "
            "the file is truncated or damaged"
        )
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
    """Reads a body in which the fields follow each other: two sizes, and a block compressed by LZF."""
    size = header.num_points * header.point_size
    packed, unpacked = struct.unpack("<II", body[:8]) if len(body) >= 8 else (0, 0)
    if packed > len(body) - 8 or body[8 + packed :].strip(b"\0"):
        raise FileFormatError(
            f"expected {packed} compressed bytes as the PCD body declares, found {max(len(body) - 8, 0)}: "
            "the file is truncated or damaged"
        )
    if unpacked != size:
        raise FileFormatError(
            f"the PCD header declares {size} bytes of points, but the compressed block declares {unpacked}"
        )
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
    """Decompresses LZF, the compression of Marc Lehmann.

    The input consists of literal runs, and of back references to bytes that were already decompressed.

    Args:
        packed: compressed bytes.
        size: number of bytes after decompression.

    Raises:
        FileFormatError: if the input is damaged, or decompresses to another number of bytes.
    """
    if size > MAX_LZF_RATIO * len(packed):
        raise FileFormatError(f"{len(packed)} compressed bytes cannot contain {size} bytes")
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
                raise FileFormatError("the compressed block of the PCD is damaged: it refers to bytes before its start")
            piece = out[start : start + length]
            # a reference may overlap the bytes that it produces, which then repeat
            out += piece if len(piece) == length else (piece * (length // len(piece) + 1))[:length]
    except IndexError:
        raise FileFormatError("the compressed block of the PCD is truncated") from None
    if at != end or len(out) != size:
        raise FileFormatError(
            f"the compressed block of the PCD is damaged: it contains {len(out)} bytes or more instead of {size}"
        )
    return bytes(out)
