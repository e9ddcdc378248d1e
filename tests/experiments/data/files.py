"""Small files in the published formats, for the tests of their loaders."""

import numpy as np

from symjax.geometry.plane import Plane

OFF = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""
TABLE = """2
0 -3.61376 -1.39425
0 -3.61376 1.39425
0 3.61376 -1.39425
5.19097
-2.59548 0 -1.39425
2.59548 0 -1.39425
-2.59548 0 1.39425
7.22751
"""


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def same(plane, normal, offset):
    """Whether a plane has this normal and offset, up to a common sign."""
    n, w = plane.canonical()
    other = Plane(np.array(normal, float), np.asarray(float(offset))).canonical()
    return np.allclose(n, other.normal, atol=1e-9) and np.allclose(w, other.offset, atol=1e-9)
