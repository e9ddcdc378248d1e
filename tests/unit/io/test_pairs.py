"""Files of pairs: six numbers per row in any usual format, or an error that says what is wrong."""

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io.pairs import read_pairs


@pytest.fixture
def ends(rng):
    return rng.normal(size=(20, 6))


@pytest.mark.parametrize("suffix", [".csv", ".txt", ".xyz", ".CSV"])
@pytest.mark.parametrize("delimiter", [",", ";", " ", "\t"])
@pytest.mark.parametrize("head", ["", "x{0}y{0}z{0}x2{0}y2{0}z2\n", "# made by hand\n"])
def test_text_is_read_exactly(ends, tmp_path, suffix, delimiter, head):
    rows = "\n".join(delimiter.join(map(repr, row)) for row in ends.tolist())
    path = tmp_path / f"pairs{suffix}"
    path.write_text(head.format(delimiter) + rows + "\n")
    x, y, note = read_pairs(path)
    np.testing.assert_array_equal(np.c_[x, y], ends)
    assert note == "20 pairs"


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int16])
def test_arrays_are_read_exactly(ends, tmp_path, dtype):
    np.save(tmp_path / "pairs.npy", (10 * ends).astype(dtype))
    x, y, _ = read_pairs(tmp_path / "pairs.npy")
    assert x.dtype == np.float64
    np.testing.assert_array_equal(np.c_[x, y], (10 * ends).astype(dtype))


@pytest.mark.parametrize(
    ("name", "content", "why"),
    [
        ("a.csv", b"", "it contains no pairs"),
        ("a.csv", b"# nothing\n\n", "it contains no pairs"),
        ("a.csv", b"x,y,z,u,v,w\n", "it contains no pairs"),
        ("a.csv", b"1,2,3\n4,5,6\n", "line 1: expected 6 columns .*, found 3 in '1,2,3'"),
        ("a.csv", b"1,2,3,4,5,6\n\n1,2,3,4,5,6,7\n", "line 3: expected 6 columns"),
        ("a.csv", b"1,2,3,4,5,6\n1,2,3,4,5\n", "line 2: expected 6 columns"),
        ("a.csv", b"1,2,3,4,5,6\n1,2,3,4,5,six\n", "line 2: expected a number in column 6, found 'six'"),
        ("a.txt", b"1 2 3\0 4 5 6\n", "contains NUL bytes"),
        ("a.ply", b"ply\n", "extension '.ply' is not supported: use one of .csv, .txt, .xyz, .npy"),
        ("a.csv", b"1;2,5;3;4;5;6\n1;2.5;3;4;5;6\n", "line 1: .* write all numbers with decimal points"),
        ("a.npy", b"1,2,3,4,5,6\n", "not an NPY file"),
        ("a.npy", b"", "not an NPY file"),
    ],
)
def test_bad_files_are_refused(tmp_path, name, content, why):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match=f"cannot read pairs from .*{name}.*{why}"):
        read_pairs(path)


def test_arrays_of_another_kind_are_refused(ends, tmp_path):
    path = tmp_path / "pairs.npy"
    for array in (ends[:, :3], ends.ravel(), ends > 0, ends + 1j):
        np.save(path, array)
        with pytest.raises(FileFormatError, match=r"expected real numbers of shape \(n, 6\), found"):
            read_pairs(path)
    np.save(path, np.array([{}] * 6, object).reshape(1, 6), allow_pickle=True)
    with pytest.raises(FileFormatError, match="pickled"):
        read_pairs(path)
    np.save(path, ends)
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(FileFormatError, match="declares more data than the file contains"):
        read_pairs(path)
    np.save(path, ends)
    path.write_bytes(path.read_bytes() + b"\0")
    with pytest.raises(FileFormatError, match=r"expected 20 rows .*, found 1 bytes after them"):
        read_pairs(path)
    np.save(path, ends[:0])
    with pytest.raises(FileFormatError, match="it contains no pairs"):
        read_pairs(path)


def test_decimal_commas_are_read_where_semicolons_separate_columns(ends, tmp_path):
    ends = np.vstack([np.arange(6.0), ends])
    rows = [";".join(map(repr, row)).replace(".", ",") for row in ends.tolist()]
    (tmp_path / "pairs.csv").write_text("\n".join(["0;1;2;3;4;5", *rows[1:]]))
    x, y, _ = read_pairs(tmp_path / "pairs.csv")
    np.testing.assert_array_equal(np.c_[x, y], ends)


def test_missing_files_and_folders_are_refused(tmp_path):
    with pytest.raises(FileFormatError, match="No such file"):
        read_pairs(tmp_path / "none.csv")
    with pytest.raises(FileFormatError, match="it is a folder"):
        read_pairs(tmp_path)
