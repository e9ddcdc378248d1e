"""The command `symjax`: help and errors appear at once."""

import pytest


@pytest.mark.parametrize(
    ("arguments", "status", "absent"),
    [
        (["--help"], 0, {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["detect", "--help"], 0, {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["--version"], 0, {"jax", "scipy", "trimesh", "plotly", "numpy"}),
        (["detect", "nowhere.ply"], 2, {"jax", "scipy", "trimesh", "plotly"}),
    ],
)
def test_help_and_file_errors_import_nothing_slow(modules_after, arguments, status, absent):
    returned, modules = modules_after(*arguments)
    assert returned == status
    assert not absent & modules


def test_no_arguments_show_the_help(run):
    status, out, err = run()
    assert (status, err) == (0, "")
    assert "Commands:" in out


def test_a_wrong_command_is_one_line_and_status_2(run):
    status, out, err = run("mirror")
    assert (status, out) == (2, "")
    assert err.startswith("symjax: error: No such command")
    assert err.count("\n") == 1
