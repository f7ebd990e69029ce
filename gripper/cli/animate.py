"""``gripper animate``: a scene's motion as a film."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, INTERRUPTED, progress, stop, writing
from gripper.cli.run import solved


def animate(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="FILE", help=".gif, or .mp4 with ffmpeg; out/ and the scene's name, if not given."
        ),
    ] = None,
    seconds: Annotated[float, typer.Option(help="How long it lasts, about.")] = 5.0,
    pixels: Annotated[int, typer.Option(help="Its width.")] = 720,
) -> None:
    """Solve every pose of a scene and write them as a film.

    Exit status: 0, or 1 when a pose has no answer (it is shown without a finger), 2 when the scene is bad or the file
    cannot be written (nothing is written), 130 when interrupted.
    """
    path = output or Path("out", scene_file.stem).with_suffix(".gif")
    try:
        _animate(scene_file, path, seconds, pixels)
    except KeyboardInterrupt:
        stop("interrupted: the film is not complete and was not written", INTERRUPTED)


def _animate(scene_file: Path, path: Path, seconds: float, pixels: int) -> None:
    from gripper.plot import check_film
    from gripper.scenefile import SceneFileError, read

    try:
        scene = read(scene_file)
        check_film(scene, path, seconds, pixels)
        with progress() as report:
            result = solved(scene, scene_file, report)
        with writing(path.parent), progress("frames") as report:
            path.parent.mkdir(parents=True, exist_ok=True)
            result.animate(path, seconds=seconds, pixels=pixels, progress=report)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    except ValueError as error:  # of the film: its file, size or time, or a scene without motion
        if " must " not in str(error):
            raise
        stop(f"{scene_file}: {error}", BAD_INPUT)
    typer.echo(path)
    if result.failed:
        raise typer.Exit(FAILED_POSE)
