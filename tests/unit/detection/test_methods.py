"""The methods that are known by name."""

import subprocess
import sys

import symjax
from symjax.detection.methods import METHODS, NAMED


def test_every_name_gives_a_method():
    assert tuple(NAMED) == METHODS
    for named in NAMED.values():
        assert isinstance(named(), symjax.Method)
    assert (NAMED["robust"](), NAMED["sym-hks"]()) == (symjax.Robust(), symjax.SymHKS())


def test_the_names_are_listed_without_importing_what_the_methods_need():
    code = "import sys, symjax.detection.methods; sys.exit(bool({'jax', 'scipy'} & sys.modules.keys()))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
