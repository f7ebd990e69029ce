"""``gripper check``: whether a scene keeps its limits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import BAD_INPUT, INTERRUPTED, progress, stop

if TYPE_CHECKING:
    from gripper.limits import Verdict
    from gripper.result import Result

NOT_KEPT = 1


def check(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
) -> None:
    """Judge the limits that a scene's table of limits gives; print pass or fail for each, and the pose that decides.

    Exit status: 0 when all are kept; 1 when one is not, or cannot be shown to be, because poses have no answer; 2
    when the scene is bad; 130 when interrupted.
    """
    try:
        _check(scene_file)
    except KeyboardInterrupt:
        stop("interrupted: nothing was judged", INTERRUPTED)


def _check(scene_file: Path) -> None:
    from gripper.cli.run import solved
    from gripper.limits import LIMITS, judged
    from gripper.scenefile import SceneFileError, read

    try:
        scene = read(scene_file)
        if scene.limits is None:
            stop(f"{scene_file}: limits: must be given, as [limits] with one of {', '.join(LIMITS)}", BAD_INPUT)
        with progress() as report:
            result = solved(scene, scene_file, report)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    verdicts = judged(scene.limits, result.summary())
    for verdict in verdicts:
        typer.echo(_line(verdict, result))
    kept = sum(verdict.passed for verdict in verdicts)
    typer.echo(f"limits kept: {kept} of {len(verdicts)}")
    for i, pose in enumerate(result.poses):
        if pose.status == "failed":
            typer.echo(f"pose {i}: {pose.reason}", err=True)
    if kept < len(verdicts):
        raise typer.Exit(NOT_KEPT)


def _line(verdict: Verdict, result: Result) -> str:
    """One limit in one line."""
    from gripper.results.summary import QUANTITIES

    unit = QUANTITIES[verdict.quantity]
    word = "pass" if verdict.passed else "FAIL"
    found = "" if verdict.value is None else f"{verdict.value:.6g} {unit}".strip()
    where = "" if verdict.at is None else f"at {result.parameter} = {verdict.at:.6g}"
    said = "; ".join(filter(None, (f"{found} {where}".strip(), verdict.reason)))
    return f"{word}  {verdict.limit:28}{f'{verdict.bound:.6g} {unit}'.strip():>12}   {said}"
