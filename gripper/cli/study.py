"""``gripper study``: error against run time, theory against theory, and where the solver's limits are."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, INTERRUPTED, output_folder, progress, stop, writing

if TYPE_CHECKING:
    from gripper.scene import Scene

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def study(
    scene_file: Annotated[
        Path | None, typer.Argument(metavar="SCENE.toml", help="The scene; none with --robustness.", show_default=False)
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Folder to write to; out/study, if not given."),
    ] = None,
    at: Annotated[
        list[float] | None,
        typer.Option(help="Pose, as the motion's parameter; where the force is largest, or three, if not given."),
    ] = None,
    models: Annotated[bool, typer.Option("--models", help="Compare theories, from the handbook to elements.")] = False,
    robustness: Annotated[
        bool,
        typer.Option("--robustness", help="Solve extreme scenes and random ones; resumable."),
    ] = False,
    scenes: Annotated[int, typer.Option(help="Random scenes of --robustness.", min=0)] = 2000,
    seed: Annotated[int, typer.Option(help="Of the random scenes.", min=0)] = 0,
    quick: Annotated[bool, typer.Option("--quick", help="Few and coarse points, one repeat.")] = False,
) -> None:
    """Measure error against run time: this project, the paper's scheme, CasADi/IPOPT where it is installed.

    Writes work_precision.csv and work_precision.png; with --models, models.csv; with --robustness, robustness.csv
    and robustness.png; and prints the table. One thread; a minute or more.

    Exit status: 0; 1 where there is nothing to compare with or a scene came out wrong; 2 for a bad scene or option;
    130 when interrupted.
    """
    folder = output or Path("out", "study")
    if models and robustness:
        stop("--models and --robustness must not stand together", BAD_INPUT)
    if (scene_file is None) != robustness:
        stop("a scene must be given, but for --robustness, which makes its own", BAD_INPUT)
    try:
        if not one_thread():
            return
        if scene_file is None:
            _robustness(folder, scenes, seed, quick)
        elif models:
            _models(scene_file, folder, at, quick)
        else:
            _study(scene_file, folder, at, quick)
    except KeyboardInterrupt:
        stop("interrupted" + ("; the same command goes on from here" if robustness else ""), INTERRUPTED)


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


def _robustness(folder: Path, scenes: int, seed: int, quick: bool) -> None:
    from gripper.study.robustness import scenes as made
    from gripper.study.robustness import study as judged
    from gripper.study.robustness import summary
    from gripper.study.verdicts import verdicts

    record, picture = folder / "robustness.csv", folder / "robustness.png"
    # the scenes are its own: an OSError is the folder's
    with output_folder(folder, (record.name, picture.name)), writing(folder):
        with progress("scenes") as report:
            found = judged(made(scenes, seed, quick=quick), record, report)
        verdicts(found).savefig(picture)
    typer.echo(summary(found))
    typer.echo(record)
    typer.echo(picture)
    if any(each.verdict == "wrong" for each in found):
        raise typer.Exit(FAILED_POSE)


def _models(scene_file: Path, folder: Path, at: list[float] | None, quick: bool) -> None:
    from gripper.output import write_files
    from gripper.study.models import models as compared

    scene, name = scene_of(scene_file), "models.csv"
    try:
        with output_folder(folder, (name,)):
            with progress("models") as report:
                found = compared(scene, at, quick=quick, progress=report)
            with writing(folder):
                paths = write_files(folder, {name: found.csv().encode()})
    except ValueError as error:
        stop(f"{scene_file}: {error}", BAD_INPUT)
    typer.echo(str(found))
    for path in paths:
        typer.echo(path)


def _study(scene_file: Path, folder: Path, at: list[float] | None, quick: bool) -> None:
    import io

    from gripper.output import write_files
    from gripper.study.diagram import diagram
    from gripper.study.precision import study as measured
    from gripper.study.shot import NoReferenceError

    if at is not None and len(at) > 1:
        stop(f"--at must be one pose here; got {len(at)}", BAD_INPUT)
    scene, names = scene_of(scene_file), ("work_precision.csv", "work_precision.png")
    try:
        with output_folder(folder, names):
            with progress("points") as report:
                found = measured(scene, at[0] if at else None, quick=quick, progress=report)
            picture = io.BytesIO()
            diagram(found).savefig(picture, format="png")
            with writing(folder):
                paths = write_files(folder, dict(zip(names, (found.csv().encode(), picture.getvalue()), strict=True)))
    except NoReferenceError as error:
        stop(f"{scene_file}: {error}", FAILED_POSE)
    except ValueError as error:
        stop(f"{scene_file}: {error}", BAD_INPUT)
    typer.echo(str(found))
    for path in paths:
        typer.echo(path)
