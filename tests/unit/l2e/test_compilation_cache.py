"""The persistent compilation cache, in processes of their own: it is a setting of the process."""

import subprocess
import sys

import pytest

PROGRAM = """
import sys, numpy as np, jax, symjax
counts = []
jax.monitoring.register_event_listener(lambda event, **_: counts.append(event))
folder = symjax.enable_compilation_cache(sys.argv[1] if len(sys.argv) > 1 else None)
rng = np.random.default_rng(0)
x = rng.normal(size=(50, 3))
symjax.fit_plane(x, x * [-1, 1, 1], 0.1, [1.0, 0.0, 0.0])
print(folder, counts.count("/jax/compilation_cache/cache_hits"), counts.count("/jax/compilation_cache/cache_misses"))
"""


def run(*arguments, **environment):
    import os

    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | environment,
    )
    folder, hits, misses = done.stdout.split()
    return folder, int(hits), int(misses)


def test_what_one_process_compiled_the_next_one_loads(tmp_path):
    folder = tmp_path / "cache"
    _, hits, misses = run(str(folder))
    assert hits == 0
    assert misses > 0
    assert any(folder.iterdir())
    assert run(str(folder)) == (str(folder), misses, 0)


@pytest.mark.slow
def test_the_folder_is_that_of_the_environment(tmp_path):
    folder, _, _ = run(SYMJAX_CACHE=str(tmp_path / "named"))
    assert folder == str(tmp_path / "named")
    assert any((tmp_path / "named").iterdir())
