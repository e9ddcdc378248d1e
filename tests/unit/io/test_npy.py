"""NPY: arrays of any real type and memory order, and files that match their header."""

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io.points import read_points
from tests.helpers.cloud_files import CUBE, npy, put


def test_a_header_that_declares_gigabytes_allocates_nothing(tmp_path):
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (200000000, 3), }".ljust(117) + b"\n"
    lies = b"\x93NUMPY\x01\x00" + np.uint16(len(header)).tobytes() + header + b"\0" * 24
    with pytest.raises(FileFormatError, match="declares more data than the file contains"):
        read_points(put(tmp_path, "a.npy", lies))


def test_integers_and_fortran_order_in_npy(tmp_path):
    for array in (np.asfortranarray(CUBE), CUBE.astype("i1"), CUBE.astype(">f4")):
        back = read_points(put(tmp_path, "a.npy", npy(array))).points
        assert back.dtype == np.float64
        np.testing.assert_array_equal(back, CUBE)


def test_a_signalling_nan_is_read_without_a_warning(tmp_path):
    signalling = np.full((4, 3), 0x7FA00000, np.uint32).view(np.float32)
    assert np.isnan(read_points(put(tmp_path, "a.npy", npy(signalling))).points).all()
