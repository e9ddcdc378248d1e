"""The command `symjax`: its subcommands and their errors."""

import sys
from collections.abc import Sequence

import click

from symjax import __version__
from symjax.cli import demo, detect, sweep

BAD_INPUT = 2
"""Exit status for invalid files, points and options."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Runs the command `symjax`. An error is printed as one line on stderr and gives exit status 2.

    Args:
        arguments: command-line arguments; None means those of the process.
    """
    try:
        sys.exit(commands.main(arguments, prog_name="symjax", standalone_mode=False))
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        sys.exit(0)
    except click.UsageError as error:
        help_command = f"{error.ctx.command_path} --help" if error.ctx else "symjax --help"
        _fail(f"{error.format_message()} (see {help_command})")
    except click.ClickException as error:
        _fail(error.format_message())
    except click.Abort:
        click.echo("symjax: interrupted", err=True)
        sys.exit(130)


def _fail(message: str) -> None:
    click.echo(f"symjax: error: {' '.join(message.split())}", err=True)
    sys.exit(BAD_INPUT)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="symjax")
def commands() -> None:
    """Find the mirror plane of a 3D point cloud."""


for module in (detect, demo, sweep):
    commands.add_command(module.command)
