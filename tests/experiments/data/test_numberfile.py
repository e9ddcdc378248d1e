"""Text files of numbers."""

import pytest

from experiments.data.numberfile import NumberFile
from symjax.errors import FileFormatError


def test_binary_content_is_named(tmp_path):
    path = tmp_path / "a-plane.txt"
    path.write_bytes(b"1\0")
    with pytest.raises(FileFormatError, match=r"a-plane\.txt: it contains NUL bytes"):
        NumberFile(path)
