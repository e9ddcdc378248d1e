"""PRS-Net's ShapeNet models and planes."""

import numpy as np
import pytest
from scipy.io import savemat

from experiments.data import shapenet
from experiments.framework.absence import DataAbsentError
from symjax.errors import FileFormatError
from tests.experiments.data.files import OBJ, same, write


def write_shapenet(tmp_path, cells, ids="a1 3,1\nb2 1\n"):
    write(tmp_path / "1000.txt", ids)
    savemat(tmp_path / "gt_planes.mat", {"gt_planes": cells})


def cell_array(rows):
    cells = np.empty((len(rows), 3), object)
    for i, row in enumerate(rows):
        for j in range(3):
            cells[i, j] = np.array([row[j]] if j < len(row) else [])
    return cells


def test_shapenet_models_are_loaded_with_their_planes(tmp_path):
    near = [np.cos(0.05), np.sin(0.05), 0.0, 0.0]
    write_shapenet(tmp_path, cell_array([[[2.0, 0, 0, -1.0], near, [0, 1, 0, 0.25]], [[0.0, 0, 0, 0], [0, 0, 1, 0]]]))
    write(tmp_path / "ShapeNetCore.v2" / "02691156" / "a1" / "models" / "model_normalized.obj", OBJ)
    write(tmp_path / "objs" / "b2.obj", OBJ)
    a, b = shapenet.load(tmp_path)
    assert (a.name, len(a.planes), b.name, len(b.planes)) == ("a1", 2, "b2", 1)
    # ax + by + cz + d = 0
    assert same(a.planes[0], [1, 0, 0], 0.5)
    assert same(a.planes[1], [0, 1, 0], -0.25)
    assert same(b.planes[0], [0, 0, 1], 0)
    assert len(a.surface.triangles) == 4


def test_shapenet_names_the_missing_models(tmp_path):
    write_shapenet(tmp_path, cell_array([[[1.0, 0, 0, 0]], [[1.0, 0, 0, 0]]]))
    with pytest.raises(DataAbsentError, match="2 of 2 models"):
        shapenet.load(tmp_path)
    write(tmp_path / "objs" / "b2.obj", OBJ)
    with pytest.raises(DataAbsentError, match=r"1 of 2 models .* the first of them a1"):
        shapenet.load(tmp_path)


def test_malformed_files_of_shapenet_are_refused(tmp_path):
    write_shapenet(tmp_path, cell_array([[[1.0, 0, 0, 0]]]))
    with pytest.raises(FileFormatError, match=r"lists 2 models, .* planes for 1"):
        shapenet.load(tmp_path)
    write_shapenet(tmp_path, cell_array([[[1.0, 0, 0, 0]], [[1.0, 0]]]))
    with pytest.raises(FileFormatError, match=r"gt_planes\.mat, row 2"):
        shapenet.load(tmp_path)
    write_shapenet(tmp_path, np.eye(4))
    with pytest.raises(FileFormatError, match="not a cell array"):
        shapenet.load(tmp_path)
    write(tmp_path / "gt_planes.mat", "text")
    with pytest.raises(FileFormatError, match=r"gt_planes\.mat: not a MAT file"):
        shapenet.load(tmp_path)
    write(tmp_path / "1000.txt", "a1 3,1\n../b2 1\n")
    with pytest.raises(FileFormatError, match=r"1000\.txt, line 2"):
        shapenet.load(tmp_path)
