"""``gripper run``: every pose of a scene, and its files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import (
    BAD_INPUT,
    FAILED_POSE,
    INTERRUPTED,
    Output,
    Progress,
    interruptible,
    output_folder,
    progress,
    stop,
    writing,
)

if TYPE_CHECKING:
    from gripper.result import Result
    from gripper.scene import Scene


def run(
    scene_file: Annotated[
        Path,
        typer.Argument(metavar="SCENE.toml", help="The scene; or a result.json, for its scene.", show_default=False),
    ],
    output: Output = None,
) -> None:
    """Solve every pose of a scene; write result.json, curve.csv and snapshots.png.

    Exit status: 0, or 1 when a pose has no answer (all other poses are written), 2 when the scene is bad or the
    folder cannot be written (nothing is written), 130 when interrupted (the poses done until then are written).
    """
    folder = output or Path("out", scene_file.stem)
    with interruptible(f"{folder} does not hold the whole run"):
        _run(scene_file, folder)


def _run(scene_file: Path, folder: Path) -> None:
    from gripper.output import write
    from gripper.scenefile import SceneFileError, read

    try:
        scene = read(scene_file)
        import gripper.trace  # noqa: F401  # what takes time to import, before there is a folder
        from gripper.results.report import as_text

        with output_folder(folder):
            result, interrupted = _as_far_as_it_goes(scene, scene_file)
            try:
                with writing(folder):
                    paths = write(folder, result)
            finally:  # also where the disk is full
                typer.echo(as_text(result, f"{folder / 'result.json'}"))
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    typer.echo()
    for path in paths:
        typer.echo(path)
    if interrupted:
        stop(f"interrupted: {interrupted}; the others are written as failed", INTERRUPTED)
    if result.failed:
        raise typer.Exit(FAILED_POSE)


def _as_far_as_it_goes(scene: Scene, scene_file: Path) -> tuple[Result, str]:
    """The result, and where it was interrupted."""
    from gripper.trace import Interrupted

    try:
        with progress() as report:
            return solved(scene, scene_file, report), ""
    except Interrupted as interruption:
        return interruption.result, str(interruption)


def solved(scene: Scene, scene_file: Path, report: Progress | None) -> Result:
    """Every pose of a scene read from a file.

    Raises
    ------
    SceneFileError
        Where a rule of the scene shows only along the finger or the motion, no pose can be reached, or a plugin of
        another distribution fails.
    """
    import numpy as np

    from gripper.pose import placed
    from gripper.registry import blamed
    from gripper.scenefile import SceneFileError
    from gripper.solve import solve
    from gripper.trace import trace

    finger = placed(scene.finger).body
    try:
        with np.errstate(all="ignore"):  # the checks of each pose judge it
            result = trace(scene, progress=report) if scene.motion else solve(scene)
    except Exception as error:
        plugin = blamed(error, finger, finger.jaw, placed(scene.object).body)
        if plugin:
            what = " ".join(f"{type(error).__name__}: {error}".split())
            raise SceneFileError(
                f"{scene_file}: must be solved with plugins that work; got {what} of {plugin}"
            ) from error
        if not isinstance(error, ValueError) or " must " not in str(error):
            raise
        # a rule that shows only along the finger or the motion
        raise SceneFileError(f"{scene_file}: {error}") from error
    _check_reached(result, scene_file)
    return result


def _check_reached(result: Result, scene_file: Path) -> None:
    """Refuse a scene of which no pose can be reached, whatever the finger does."""
    from gripper.motion.approach import HELD
    from gripper.motion.stride import ON_CLAMP
    from gripper.scenefile import SceneFileError

    reasons = {pose.reason or "" for pose in result.poses}
    if reasons == {ON_CLAMP}:
        rule = "must leave the finger's clamp outside the object"
        raise SceneFileError(f"{scene_file}: object.pose: {rule}; got the clamp inside in every pose")
    if all(reason.startswith(HELD) for reason in reasons):
        rule = "must be one along which the object comes from where it is free"
        raise SceneFileError(f"{scene_file}: approach.direction: {rule}; got {result.scene.approach}")
