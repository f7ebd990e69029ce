"""``gripper verify``: a scene's poses beside two-dimensional finite elements."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, INTERRUPTED, output_folder, progress, stop, writing
from gripper.cli.run import solved

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from gripper.result import Result
    from gripper.scene import Scene
    from gripper.verify import Verification

FILES = ("verify.json", "verify.csv", "verify.md")
MOST_POSES = 7


def verify(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
    poses: Annotated[
        str | None,
        typer.Option(
            metavar="VALUES",
            help='Values of the motion\'s parameter, as "0.05, 62 mm", or "all"; '
            f"{MOST_POSES} of the poses in contact, if not given.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="DIR", help="Folder to write to; out/ and the scene's name, if not given."
        ),
    ] = None,
    law: Annotated[
        Literal["svk", "biot", "hencky", "neo_hookean"] | None,
        typer.Option(
            help="St. Venant-Kirchhoff, linear in the stretch (the beam's counterpart), logarithmic, or neo-Hookean; "
            "the material's own, if not given, svk where that is linear."
        ),
    ] = None,
    elements: Annotated[
        str, typer.Option(metavar="ALONGxACROSS", help="Along the finger and across; the second mesh has half as many.")
    ] = "108x4",
    jaw: Annotated[Literal["rigid", "elastic"], typer.Option(help="Rigid, or of the finger's own material.")] = "rigid",
    laws: Annotated[bool, typer.Option(help="Say also what the other material laws alone change.")] = True,
    within: Annotated[
        str | None,
        typer.Option(metavar="PART", help='Largest difference of the forces that passes, as "1 %"; any, if not given.'),
    ] = None,
) -> None:
    """Compare a scene with two-dimensional finite elements; write verify.json, verify.csv and verify.md.

    A second opinion: it shares the object and the finger's profile with the solver, nothing else. It follows the
    motion from its start: seven poses take about 20 s, and twice as many elements each way five times as long.

    Exit status: 0, or 1 when the elements or gripper have no answer for a pose (all others are written) or the forces
    differ by more than --within, 2 when the scene or an option is bad or the folder cannot be written (nothing is
    written), 130 when interrupted.
    """
    from gripper.scenefile import SceneFileError

    folder, limit = output or Path("out", scene_file.stem), _part(within)
    try:
        options = {"elements": elements, "law": law, "jaw": jaw, "laws": laws}
        report, paths = _verified(scene_file, folder, poses, options)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    except KeyboardInterrupt:
        stop("interrupted: the comparison is not complete and was not written", INTERRUPTED)
    typer.echo(str(report))
    for path in paths:
        typer.echo(path)
    if limit is not None and (largest := report.largest_difference or 0.0) > limit:
        stop(f"the forces differ by up to {100 * largest:.2f} %, more than --within {within}", FAILED_POSE)
    if report.failed:
        raise typer.Exit(FAILED_POSE)


def _verified(
    scene_file: Path, folder: Path, poses: str | None, options: Mapping[str, Any]
) -> tuple[Verification, tuple[Path, ...]]:
    """Compare, and write the files.

    Raises
    ------
    SceneFileError
        A scene or an option against its rule.
    """
    from gripper.output import as_json, write_files
    from gripper.scenefile import read

    scene, options = read(scene_file), {**options, "elements": _mesh(options["elements"])}
    values = _values(poses, scene)
    with output_folder(folder, FILES):
        report = _compared(scene, scene_file, values, options)
        contents = as_json(report.to_dict()), report.csv().encode(), report.markdown().encode()
        with writing(folder):
            return report, write_files(folder, dict(zip(FILES, contents, strict=True)))


def _compared(
    scene: Scene, scene_file: Path, values: Sequence[float] | None, options: Mapping[str, Any]
) -> Verification:
    from gripper.scenefile import SceneFileError
    from gripper.verify import verify as compare

    result = None
    if values is None:
        with progress() as tick:
            result = solved(scene, scene_file, tick)
        values = _spread(result)
    try:
        with progress("finite elements") as tick:
            return compare(scene, values, result=result, progress=tick, **options)
    except ValueError as error:
        if " must " not in str(error):
            raise
        # a rule that shows only when the finger is meshed or the motion is followed
        raise SceneFileError(f"{scene_file}: {error}") from error


def _mesh(text: str) -> tuple[int, int]:
    along, _, across = text.partition("x")
    if not (along.isdecimal() and across.isdecimal()):
        stop(f"elements must be two whole numbers, as 108x4; got {text!r}", BAD_INPUT)
    return int(along), int(across)


def _part(text: str | None) -> float | None:
    """A part of one, written as a number or in per cent."""
    from gripper.expression import number
    from gripper.expression.dimensions import PURE

    if text is None:
        return None
    rule = "within must be a positive number, or one with %"
    try:
        part = number(text.removesuffix("%").strip(), PURE) * (0.01 if text.endswith("%") else 1.0)
    except ValueError as error:
        stop(f"{rule}: {error}", BAD_INPUT)
    return part if part > 0 else stop(f"{rule}; got {text!r}", BAD_INPUT)


def _values(text: str | None, scene: Scene) -> Sequence[float] | None:
    """The values asked for; None to have them chosen."""
    from gripper.expression import number

    if text is None:
        return None
    if text.strip() == "all":
        return scene.motion.values if scene.motion else None
    try:
        return [number(part) for part in text.split(",")]
    except ValueError as error:
        stop(f"poses must be numbers with commas between, or all: {error}", BAD_INPUT)


def _spread(result: Result) -> list[float] | None:
    """Some of the poses in contact, from the first to the last; of all poses where none is."""
    motion = result.scene.motion
    if motion is None:
        return None
    touching = [value for value, pose in zip(motion.values, result.poses, strict=True) if pose.status == "contact"]
    values = touching or list(motion.values)
    steps = min(MOST_POSES, len(values))
    return [values[round(i * (len(values) - 1) / max(steps - 1, 1))] for i in range(steps)]
