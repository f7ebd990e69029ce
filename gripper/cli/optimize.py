"""``gripper optimize``: the best numbers for a scene."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from gripper.cli.console import BAD_INPUT, INTERRUPTED, Output, interruptible, output_folder, progress, stop, writing

if TYPE_CHECKING:
    from gripper.optimize import Optimum
    from gripper.scenefile.optimize import Task

NOT_KEPT = 1
FILES = ("best.toml", "result.json", "history.csv")


def optimize(
    design_file: Annotated[
        Path, typer.Argument(metavar="DESIGN.toml", help="A scene with an [optimize] table.", show_default=False)
    ],
    output: Output = None,
) -> None:
    """Search the free numbers of a design for its objective, within its [limits]; write best.toml and the history.

    [optimize] gives minimize, maximize or flatten = "a quantity of the summary", starts and seed; [optimize.free] the
    least and largest value of each free number: "finger.thickness" = ["2 mm", "5 mm"].

    Where no design keeps all limits, the one that violates them least is written. Ctrl-C keeps the best design so far
    and the history.

    Exit status: 0; 1 when no design that keeps all limits was found; 2 when the design is bad; 130 when interrupted.
    """
    folder = output or Path("out", design_file.stem)
    with interruptible(f"{folder} holds nothing of this search"):
        _optimize(design_file, folder)


def _optimize(design_file: Path, folder: Path) -> None:
    from gripper.scenefile import SceneFileError
    from gripper.scenefile.optimize import read_design

    try:
        task = read_design(design_file)
        with output_folder(folder, FILES):
            best, interrupted = _as_far_as_it_goes(task, design_file)
            with writing(folder):
                paths = _write(folder, best)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    typer.echo(str(best))
    for path in paths:
        typer.echo(path)
    if interrupted:
        stop(f"interrupted: {interrupted}; the best of them is written", INTERRUPTED)
    if not best.kept:
        raise typer.Exit(NOT_KEPT)


def _as_far_as_it_goes(task: Task, design_file: Path) -> tuple[Optimum, str]:
    """What was found, and where the search was interrupted."""
    from gripper.optimize import Interrupted

    try:
        return _searched(task, design_file), ""
    except Interrupted as interruption:
        return interruption.optimum, str(interruption)


def _searched(task: Task, design_file: Path) -> Optimum:
    from gripper.optimize import optimize as search
    from gripper.scenefile import SceneFileError

    with progress("designs") as report:
        told = None if report is None else lambda done, _: report(done, None)  # type: ignore[arg-type]
        try:
            goal: dict[str, Any] = dict(task.goal)
            return search(task.scene, task.free, starts=task.starts, seed=task.seed, progress=told, **goal)
        except (LookupError, ValueError) as error:
            raise SceneFileError(f"{design_file}: optimize: {error.args[0]}") from error


def _write(folder: Path, best: Optimum) -> tuple[Path, ...]:
    from gripper.output import as_json, write_files
    from gripper.scenefile import dumps

    parts = (
        lambda: dumps(best.scene).encode(),
        lambda: as_json(best.result.to_dict()),
        lambda: best.history_csv().encode(),
    )
    return write_files(folder, dict(zip(FILES, parts, strict=True)))
