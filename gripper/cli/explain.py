"""``gripper explain``: what a scene needs, what is left out, and why."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gripper.cli.console import BAD_INPUT, INTERRUPTED, stop


def explain(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
) -> None:
    """Say which unknowns, terms, constraints and packages a scene needs, and the estimate behind each decision.

    Exit status: 0, 2 for a bad scene, 130 when interrupted.
    """
    from gripper.explain import explain as explained
    from gripper.scenefile import SceneFileError, read

    try:
        typer.echo(str(explained(read(scene_file))))
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    except ValueError as error:
        if " must " not in str(error):
            raise
        stop(f"{scene_file}: {error}", BAD_INPUT)  # a rule that shows only along the finger or the motion
    except KeyboardInterrupt:
        stop("interrupted", INTERRUPTED)
