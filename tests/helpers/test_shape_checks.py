import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

TESTS = """
import numpy as np
import pytest
from symjax.datasets.corruption import add_outliers

def test_right():
    assert add_outliers(np.zeros((9, 3)), 1).shape == (18, 3)

def test_wrong():
    add_outliers(np.zeros((9, 4)), 1.0)

def test_wrong_on_purpose():
    with pytest.raises(ValueError):
        add_outliers(np.zeros((9, 4)), 1.0)
"""


def test_a_wrong_shape_fails_a_test_under_the_option_unless_the_test_wants_it_refused(tmp_path):
    file = tmp_path / "test_shapes.py"
    file.write_text(TESTS)
    command = [sys.executable, "-m", "pytest", "-p", "tests.conftest", "-n", "0", "-o", "cache_dir=" + str(tmp_path)]
    outcome = [
        subprocess.run([*command, *options, str(file)], cwd=ROOT, capture_output=True, text=True, check=False).stdout
        for options in (["--check-shapes"], [])
    ]
    assert re.search("1 failed, 1 passed, 1 skipped", outcome[0]), outcome[0]
    assert "Expected type: <class 'Float[ndarray, 'n 3']'>" in outcome[0]
    assert re.search("1 failed, 2 passed", outcome[1]), outcome[1]  # DID NOT RAISE
