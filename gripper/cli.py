"""The command line: ``gripper run`` and ``gripper plugins``. What is heavy is imported where it is needed."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

if TYPE_CHECKING:
    from gripper.result import Result
    from gripper.scene import Scene

BAD_INPUT, FAILED_POSE, INTERRUPTED = 2, 1, 130

Progress = Callable[[int, int], None]

app = typer.Typer(
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    help="Bent shape and contact forces of compliant fingers.",
)


def main() -> None:
    """Run the command line."""
    app()


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


@app.command()
def run(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Folder to write to; out/ and the scene's name, if not given."
        ),
    ] = None,
) -> None:
    """Solve every pose of a scene; write result.json, curve.csv and snapshots.png.

    Exit status: 0, or 1 when a pose has no answer (all other poses are written), 2 when the scene is bad or the
    folder cannot be written (nothing is written), 130 when interrupted.
    """
    try:
        _run(scene_file, output or Path("out", scene_file.stem))
    except KeyboardInterrupt:
        _stop("interrupted: the run is not complete and was not written", INTERRUPTED)


@app.command()
def plugins() -> None:
    """List the objects, fingers and jaws that are installed, and whether they can be used."""
    from rich.console import Console
    from rich.table import Table

    from gripper.registry import GROUPS, check, installed

    table = Table("kind", "name", "distribution", "target", "state", box=None, pad_edge=False, header_style="bold")
    for record in (record for group in GROUPS for record in installed(group)):
        source = f"{record.distribution} {record.version}"
        table.add_row(record.kind, record.name, source, record.target, check(record) or "ok")
    # into a pipe: one line a plugin, however long
    Console(markup=False, highlight=False, emoji=False, width=None if sys.stdout.isatty() else 10_000).print(table)


def _stop(message: str, status: int) -> NoReturn:
    typer.echo(message, err=True)
    raise typer.Exit(status)


def _run(scene_file: Path, folder: Path) -> None:
    from gripper.output import prepared, write
    from gripper.scenefile import SceneFileError, read

    try:
        scene = read(scene_file)
        with _writing(folder), prepared(folder):
            with _progress() as progress:
                result = _solved(scene, scene_file, progress)
            paths = write(folder, result)
    except SceneFileError as error:
        _stop(str(error), BAD_INPUT)
    typer.echo(str(result))
    for path in paths:
        typer.echo(path)
    if result.failed:
        raise typer.Exit(FAILED_POSE)


def _solved(scene: Scene, scene_file: Path, progress: Progress | None) -> Result:
    from gripper.scenefile import SceneFileError
    from gripper.solve import solve
    from gripper.trace import trace

    try:
        return trace(scene, progress=progress) if scene.motion else solve(scene)
    except ValueError as error:
        if " must " not in str(error):
            raise
        # a rule that shows only along the finger or the motion, as a thickness below 0 or a pose of log(-1)
        raise SceneFileError(f"{scene_file}: {error}") from error


@contextlib.contextmanager
def _progress() -> Iterator[Progress | None]:
    """Show a bar on a terminal; nothing in a pipe."""
    if not sys.stderr.isatty():
        yield None
        return
    import rich.progress
    from rich.console import Console

    with rich.progress.Progress(console=Console(stderr=True), transient=True) as bars:
        bar = bars.add_task("poses", total=None)
        yield lambda done, total: bars.update(bar, completed=done, total=total)


@contextlib.contextmanager
def _writing(folder: Path) -> Iterator[None]:
    """Turn what the file system refuses into one message."""
    try:
        yield
    except OSError as error:
        _stop(f"{folder}: must be a folder that can be written; got {error.strerror or error}", BAD_INPUT)
