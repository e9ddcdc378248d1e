"""PLY: properties in any order, elements of other kinds."""

import numpy as np

from symjax.io.formats import ply


def test_ply_properties_in_any_order_and_other_elements():
    header = (
        "ply\r\nformat binary_little_endian 1.0\r\ncomment caf\xe9\r\nelement camera 1\r\nproperty float f\r\n"
        "property list uchar short k\r\nelement vertex 2\r\nproperty uchar red\r\nproperty float z\r\n"
        "property double x\r\nproperty short y\r\nelement tail 3\r\nproperty int8 a\r\nend_header\r\n"
    ).encode("latin-1")
    camera = np.float32(50).tobytes() + b"\x02" + np.array([7, 8], "<i2").tobytes()
    row = np.dtype([("red", "u1"), ("z", "<f4"), ("x", "<f8"), ("y", "<i2")])
    vertices = np.array([(255, 3, 1, 2), (0, 6, 4, 5)], row)
    read = ply.read(header + camera + vertices.tobytes() + b"abc")
    np.testing.assert_array_equal(read.vertices, [[1, 2, 3], [4, 5, 6]])
