"""Loaders refuse absent data with instructions for getting it."""

import pytest

from experiments.data import folder, funk, shapenet, shrec2016, shrec2023, ycb
from experiments.framework.absence import DataAbsentError

LOADERS = (folder.load, funk.load, shapenet.load, shrec2016.load, shrec2023.load, ycb.load)


@pytest.mark.parametrize("load", LOADERS)
def test_absent_data_is_refused_at_once_with_instructions(load, tmp_path):
    with pytest.raises(DataAbsentError, match=r"(?s)DATA IS ABSENT: no .*nowhere.*ay (it|them) out as\n  FOLDER/"):
        load(tmp_path / "nowhere")


@pytest.mark.parametrize("load", [funk.load, shrec2023.load])
def test_an_empty_folder_is_absent_data(load, tmp_path):
    with pytest.raises(DataAbsentError, match="ay it out as"):
        load(tmp_path)
