"""What every command shares: exit statuses, one message and out, a progress bar on a terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Annotated, NoReturn

import typer

BAD_INPUT, FAILED_POSE, INTERRUPTED = 2, 1, 130

Progress = Callable[[int, int], None]
Output = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="DIR", help="Folder to write to; out/ and the scene's name, if not given."),
]
"""Where a command writes."""


def stop(message: str, status: int) -> NoReturn:
    """Leave with one message on stderr."""
    typer.echo(message, err=True)
    raise typer.Exit(status)


@contextlib.contextmanager
def interruptible(message: str) -> Iterator[None]:
    """End with one message where Ctrl-C interrupts."""
    try:
        yield
    except KeyboardInterrupt:
        stop(f"interrupted: {message}", INTERRUPTED)


@contextlib.contextmanager
def progress(what: str = "poses") -> Iterator[Progress | None]:
    """Show a bar on a terminal; nothing in a pipe."""
    if not sys.stderr.isatty():
        yield None
        return
    import rich.progress
    from rich.console import Console

    with rich.progress.Progress(console=Console(stderr=True), transient=True) as bars:
        bar = bars.add_task(what, total=None)
        yield lambda done, total: bars.update(bar, completed=done, total=total)


@contextlib.contextmanager
def writing(folder: Path) -> Iterator[None]:
    """Turn what the file system refuses into one message."""
    try:
        yield
    except OSError as error:
        stop(f"{folder}: must be a folder that can be written; got {error.strerror or error}", BAD_INPUT)


@contextlib.contextmanager
def output_folder(folder: Path, names: Iterable[str] | None = None) -> Iterator[None]:
    """Prepare a folder for files of these names (a run's by default); what it refuses is one message.

    What the body raises passes: an OSError of a plugin is none of the folder's.
    """
    from gripper.output import FILES, prepared

    with contextlib.ExitStack() as inside:
        with writing(folder):
            inside.enter_context(prepared(folder, FILES if names is None else names))
        yield
