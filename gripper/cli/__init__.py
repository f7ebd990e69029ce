"""The command line: one module a command. What is heavy is imported where it is needed."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from gripper.cli.animate import animate as _animate
from gripper.cli.check import check as _check
from gripper.cli.explain import explain as _explain
from gripper.cli.optimize import optimize as _optimize
from gripper.cli.plugins import plugins as _plugins
from gripper.cli.run import run as _run
from gripper.cli.study import study as _study
from gripper.cli.sweep import sweep as _sweep
from gripper.cli.tolerance import tolerance as _tolerance
from gripper.cli.verify import verify as _verify

app = typer.Typer(
    add_completion=False,
    rich_markup_mode="markdown",  # rich's own would take [limits] for a style and leave it out
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    help="Bent shape and contact forces of compliant fingers.",
)
app.command("run")(_run)
app.command("animate")(_animate)
app.command("check")(_check)
app.command("sweep")(_sweep)
app.command("tolerance")(_tolerance)
app.command("optimize")(_optimize)
app.command("verify")(_verify)
app.command("plugins")(_plugins)
app.command("explain")(_explain)
app.command("study")(_study)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"gripper {version('gripper')}")
        raise typer.Exit


@app.callback()
def _options(
    shown: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_version, is_eager=True)
    ] = False,
) -> None:
    """Take the options that stand before a command."""
