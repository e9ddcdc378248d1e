"""Fixtures of the tests of all commands."""

import os
import subprocess
import sys

import pytest

from symjax.cli.main import main

FRESH = (
    "import sys\nfrom symjax.cli.main import main\n"
    "try: main(sys.argv[1:])\n"
    "finally: print('MODULES', *sorted(sys.modules), file=sys.stderr)"
)


@pytest.fixture
def run(capsys):
    """Runs the command and returns its exit status, stdout and stderr."""

    def call(*arguments):
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        return ended.value.code or 0, *capsys.readouterr()

    return call


@pytest.fixture
def fresh():
    """Runs a program in a new interpreter and returns its exit status, stdout and stderr."""

    def call(code, *arguments, **environment):
        kept = {name: value for name, value in os.environ.items() if name != "XLA_FLAGS"}
        command = [sys.executable, "-c", code, *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=kept | environment)
        return done.returncode, done.stdout, done.stderr

    return call


@pytest.fixture
def modules_after(fresh):
    """Runs the command in a new interpreter and returns its exit status and the imported modules."""

    def call(*arguments):
        status, _, err = fresh(FRESH, *arguments)
        return status, set(err.rsplit("MODULES", 1)[1].split())

    return call
