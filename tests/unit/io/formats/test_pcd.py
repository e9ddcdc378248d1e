"""PCD: three encodings, NaN points, damaged files, and LZF against a compressor written for the test."""

import struct

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io.formats import pcd
from symjax.io.points import read_points

HEADER = """# .PCD v0.7 - Point Cloud Data file format
VERSION 0.7
FIELDS rgb x normal y z
SIZE 4 4 4 8 2
TYPE U F F F I
COUNT 1 1 3 1 1
WIDTH {width}
HEIGHT {height}
VIEWPOINT 0 0 0 1 0 0 0
POINTS {points}
DATA {encoding}
"""
ROW = np.dtype([("rgb", "<u4"), ("x", "<f4"), ("normal", "<f4", (3,)), ("y", "<f8"), ("z", "<i2")])


@pytest.fixture
def table(rng):
    """Twelve points with x, y and z among fields of other types and counts."""
    table = np.zeros(12, ROW)
    table["rgb"] = rng.integers(2**32, size=12)
    table["x"], table["y"], table["z"] = rng.normal(size=12), rng.normal(size=12), rng.integers(-9, 9, size=12)
    return table


def header(encoding, width=12, height=1, points=None):
    points = width * height if points is None else points
    return HEADER.format(width=width, height=height, points=points, encoding=encoding).encode()


def as_ascii(table):
    cells = [[row["rgb"], repr(float(row["x"])), *row["normal"], repr(float(row["y"])), row["z"]] for row in table]
    return header("ascii", len(table)) + "".join(" ".join(map(str, row)) + "\n" for row in cells).encode()


def as_binary(table):
    return header("binary", len(table)) + table.tobytes()


def pack(data):
    """Compresses bytes by greedy LZF: a reference to the last occurrence of the next three bytes, else a literal."""
    out, literal, last, at = bytearray(), bytearray(), {}, 0

    def flush():
        for start in range(0, len(literal), 32):
            piece = literal[start : start + 32]
            out.append(len(piece) - 1)
            out.extend(piece)
        literal.clear()

    while at < len(data):
        key = data[at : at + 3]
        back = at - last.get(key, at - 10_000) - 1
        last[key] = at
        if len(key) < 3 or back >= 8192:
            literal.append(data[at])
            at += 1
            continue
        length = 3
        while length < 264 and at + length < len(data) and data[at + length] == data[at + length - back - 1]:
            length += 1
        flush()
        short = min(length - 2, 7)
        out.append(short << 5 | back >> 8)
        if short == 7:
            out.append(length - 9)
        out.append(back & 255)
        at += length
    flush()
    return bytes(out)


def as_compressed(table):
    columns = b"".join(table[name].tobytes() for name in ROW.names)
    packed = pack(columns)
    return header("binary_compressed", len(table)) + struct.pack("<II", len(packed), len(columns)) + packed


ENCODINGS = {"ascii": as_ascii, "binary": as_binary, "binary_compressed": as_compressed}


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_encoding_gives_the_points(tmp_path, table, encoding):
    path = tmp_path / "cloud.PCD"
    path.write_bytes(ENCODINGS[encoding](table))
    points, note = read_points(path)
    np.testing.assert_array_equal(points, np.stack([table[axis].astype(float) for axis in "xyz"], axis=1))
    assert note == "cloud of 12 points"


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_nan_points_of_an_organised_cloud_are_removed_with_a_note(tmp_path, table, encoding):
    table["x"][[2, 5]] = np.nan
    table["y"][5] = np.nan
    path = tmp_path / "cloud.pcd"
    path.write_bytes(ENCODINGS[encoding](table).replace(b"WIDTH 12\nHEIGHT 1\n", b"WIDTH 4\nHEIGHT 3\n"))
    points, note = read_points(path)
    kept = np.delete(table, [2, 5])
    np.testing.assert_array_equal(points[:, 1], kept["y"])
    assert note == "cloud of 10 points; 2 of 12 points are NaN (no measurement) and were removed"


def test_a_cloud_of_nan_alone_is_refused(tmp_path, table):
    table["x"] = np.nan
    path = tmp_path / "cloud.pcd"
    path.write_bytes(as_binary(table))
    with pytest.raises(FileFormatError, match=r"no points \(12 of 12 points are NaN"):
        read_points(path)


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_file_truncated_anywhere_is_refused_or_complete(table, encoding):
    data = ENCODINGS[encoding](table)
    whole, _ = pcd.read(data)
    for length in range(len(data)):
        try:
            cut, _ = pcd.read(data[:length])
        except FileFormatError:
            continue
        # a text file without the last digits of its last number, which no reader can notice
        assert encoding == "ascii"
        assert length >= len(data) - 3
        np.testing.assert_array_equal(cut[:-1], whole[:-1])


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_flipped_bytes_give_typed_errors_only(table, encoding, rng):
    data = np.frombuffer(ENCODINGS[encoding](table), np.uint8)
    for _ in range(500):
        damaged = data.copy()
        at = rng.integers(len(data), size=rng.integers(1, 4))
        damaged[at] = rng.integers(256, size=len(at))
        try:
            points, _ = pcd.read(damaged.tobytes())
        except FileFormatError:
            continue
        assert points.shape[1] == 3


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        (b"POINTS 12", b"POINTS 13", "declares 13 POINTS, but WIDTH x HEIGHT is 12 x 1"),
        (b"12\nHEIGHT 1", b"9999999999\nHEIGHT 99999999", "WIDTH x HEIGHT is 9999999999 x 99999999"),
        (b"POINTS 12\n", b"", None),
        (b"WIDTH 12", b"WIDTH -12", "WIDTH"),
        (b"WIDTH 12", b"WIDTH \xb2", "WIDTH"),
        (b"FIELDS rgb x", b"FIELDS rgb u", "must declare fields x, y and z"),
        (b"FIELDS rgb x", b"FIELDS x", "same number of entries, got 4, 5, 5, 5"),
        (b"TYPE U F", b"TYPE U Q", "field 'x' .* invalid type: TYPE 'Q', SIZE '4'"),
        (b"DATA binary", b"DATA packed", "line 11: DATA must be ascii, binary .* got 'packed'"),
        (b"VERSION", b"VERSE", "line 2: .* cannot start with 'VERSE'"),
        (b"WIDTH 12\nHEIGHT 1\n", b"WIDTH 11\nHEIGHT 1\n", "WIDTH x HEIGHT is 11 x 1"),
    ],
)
def test_a_header_that_contradicts_itself_or_the_body_is_refused(table, old, new, why):
    data = as_binary(table)
    assert old in data
    if why is None:
        assert len(pcd.read(data.replace(old, new))[0]) == 12
        return
    with pytest.raises(FileFormatError, match=why):
        pcd.read(data.replace(old, new))


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_header_without_fields_is_refused(encoding):
    empty = f"FIELDS\nSIZE\nTYPE\nWIDTH 0\nHEIGHT 1\nDATA {encoding}\n".encode()
    with pytest.raises(FileFormatError, match="must declare fields x, y and z"):
        pcd.read(empty + (b"" if encoding == "ascii" else bytes(8)))


def test_a_row_of_another_length_is_refused_with_its_line(table):
    lines = as_ascii(table).split(b"\n")
    lines[-4] = b" ".join(lines[-4].split()[:-1])
    with pytest.raises(FileFormatError, match=r"line 21: expected 7 numbers, found 6 in"):
        pcd.read(b"\n".join(lines))


def test_only_zeros_may_follow_the_points(table):
    data = as_binary(table)
    assert len(pcd.read(data + b"\0" * 100)[0]) == 12
    with pytest.raises(FileFormatError, match=r"expected 360 bytes of points .*, found 362"):
        pcd.read(data + b"\0\1")


def test_lzf_is_the_inverse_of_the_compressor(rng):
    words = [rng.integers(256, size=n, dtype=np.uint8).tobytes() for n in (1, 2, 3, 40, 700)]
    for data in (b"", b"a", b"a" * 1000, b"abc" * 5000, b"".join(words), b"".join(words * 4), bytes(9000)):
        assert pcd.decompress(pack(data), len(data)) == data


def test_lzf_refuses_damaged_input_and_wrong_sizes():
    packed = pack(b"abcabcabc" * 9)
    for damaged, size in [
        (packed, 80),
        (packed, 82),
        (packed[:-1], 81),
        (packed + b"\0a", 81),
        (b"\x20\x00", 3),
        (b"\x20", 3),
        (packed, 2**40),
    ]:
        with pytest.raises(FileFormatError):
            pcd.decompress(damaged, size)


@pytest.mark.parametrize(("name", "num_points"), [("cturtle.pcd", 167_198), ("milk.pcd", 13_704), ("car6.pcd", 10_031)])
def test_real_clouds_are_read(models, name, num_points):
    points, note = read_points(models / name)
    assert len(points) == num_points
    assert note == f"cloud of {num_points} points"
    # the clouds are in metres, and a wrong byte order would give other sizes
    assert (np.ptp(points, axis=0) < 10).all()
    assert (np.ptp(points, axis=0) > 0.1).all()
