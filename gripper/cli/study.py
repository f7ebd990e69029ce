"""``gripper study``: error against run time, theory against theory, and where the solver's limits are."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, INTERRUPTED, progress, stop, writing

if TYPE_CHECKING:
    from gripper.scene import Scene

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def study(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder to write to; out/study, if not given."),
    ] = None,
    at: Annotated[
        float | None,
        typer.Option(help="Pose, as the motion's parameter; where the force is largest, if not given."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few and coarse points, one repeat.")] = False,
) -> None:
    """Measure error against run time: this project, the paper's scheme, CasADi/IPOPT where it is installed.

    Writes work_precision.csv and work_precision.png, and prints the table. One thread; minutes on a slow machine.

    Exit status: 0; 1 where there is nothing to compare with; 2 for a bad scene; 130 when interrupted.
    """
    folder = output or Path("out", "study")
    try:
        if one_thread():
            _study(scene_file, folder, at, quick)
    except KeyboardInterrupt:
        stop("interrupted: nothing was written", INTERRUPTED)


def one_thread() -> bool:
    """Whether BLAS has one thread; where it has more, run the command again with one, and leave with its status.

    Its waiting threads burn CPU time, and how many there are is fixed before the first import of numpy.
    """
    if all(os.environ.get(name) == "1" for name in THREADS) or "pytest" in sys.modules:
        return True
    environment = os.environ | dict.fromkeys(THREADS, "1")
    done = subprocess.run([sys.executable, "-m", "gripper", *sys.argv[1:]], env=environment)
    raise typer.Exit(done.returncode)


def scene_of(scene_file: Path) -> Scene:
    """The scene of a file; leaves with one message where it is bad."""
    from gripper.scenefile import SceneFileError, read

    try:
        return read(scene_file)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)


def _study(scene_file: Path, folder: Path, at: float | None, quick: bool) -> None:
    import io

    from gripper.output import prepared, write_files
    from gripper.study.diagram import diagram
    from gripper.study.precision import study as measured
    from gripper.study.shooting import NoReferenceError

    scene, names = scene_of(scene_file), ("work_precision.csv", "work_precision.png")
    try:
        with writing(folder), prepared(folder, names):
            with progress("points") as report:
                found = measured(scene, at, quick=quick, progress=report)
            picture = io.BytesIO()
            diagram(found).savefig(picture, format="png", dpi=110)
            paths = write_files(folder, dict(zip(names, (found.csv().encode(), picture.getvalue()), strict=True)))
    except NoReferenceError as error:
        stop(f"{scene_file}: {error}", FAILED_POSE)
    except ValueError as error:
        stop(f"{scene_file}: {error}", BAD_INPUT)
    typer.echo(str(found))
    for path in paths:
        typer.echo(path)
