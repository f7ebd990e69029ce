"""``gripper sweep``: a scene with other numbers, many times over."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, Output, interruptible, progress, stop, writing

if TYPE_CHECKING:
    from gripper.sweep import Plan, Row, Sweep

_DRAWN = ("insertion_force", "retention_force", "strain", "force_on_object")
_SHOWN = 8


def sweep(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
    over: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=...",
            help="What varies: KEY=start:stop:n or KEY=a,b,c, numbers with units or not; again for more keys.",
            show_default=False,
        ),
    ],
    output: Output = None,
    plot: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help=f"What to draw; {', '.join(_DRAWN)} by default.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Follow a scene with every combination of other numbers, on all processors; write sweep.csv and figures.

    The table grows row by row. A sweep that was killed or interrupted goes on where it was when the same command is
    given again; a torn row is reckoned again. A variant without an answer is a row with its reason.

    Exit status: 0; 1 when a variant has no answer; 2 for bad input; 130 when interrupted.
    """
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # a process each: a BLAS library's waiting threads burn CPU time
    folder = output or Path("out", f"{scene_file.stem}_sweep")
    with interruptible(f"give the same command again to go on with {folder}"):
        _sweep(scene_file, over, folder, plot)


def _sweep(scene_file: Path, over: list[str], folder: Path, plot: list[str] | None) -> None:
    from gripper.parameters import kind
    from gripper.scenefile import SceneFileError, read
    from gripper.sweep import Plan, spread
    from gripper.sweep import sweep as run

    try:
        scene = read(scene_file)
        plan = Plan([spread(text, lambda key: kind(scene, key)) for text in over])
        names = _names(plan, plot)
        with writing(folder), progress("variants") as report:
            table = run(scene, plan, folder, progress=report)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    except (ValueError, LookupError) as error:
        stop(" ".join(f"{error.args[0]}".split()), BAD_INPUT)
    with writing(folder):
        figures = _figures(table, folder, names)
    _say(table, folder, figures)
    if table.failed:
        raise typer.Exit(FAILED_POSE)


def _names(plan: Plan, plot: list[str] | None) -> list[str]:
    """What is drawn: nothing by itself where there are more than two keys."""
    from gripper.names import known_names
    from gripper.results.summary import QUANTITIES

    for name in plot or ():
        if name not in QUANTITIES:
            raise LookupError(f"unknown quantity {name!r}; known: {known_names(name, QUANTITIES)}")
    if len(plan.over) > 2 and plot:
        raise ValueError(f"plot must be left out: a figure has one key or two; got {len(plan.over)}")
    return list(plot or _DRAWN) if len(plan.over) <= 2 else []


def _figures(table: Sweep, folder: Path, names: list[str]) -> list[Path]:
    from gripper.output import write_files

    drawn = [name for name in names if any(number is not None for number in table.numbers(name))]
    return list(write_files(folder, {f"{name}.png": _png(table, name) for name in drawn})) if drawn else []


def _png(table: Sweep, name: str) -> bytes:
    import io

    data = io.BytesIO()
    table.plot(name).savefig(data, format="png")
    return data.getvalue()


def _ranges(table: Sweep) -> list[str]:
    """The least and the largest of each number that is drawn, and the variant of the largest."""
    from gripper.results.summary import QUANTITIES

    lines = []
    for name in _DRAWN:
        rows = {row: value for row, value in zip(table.rows, table.numbers(name), strict=True) if value is not None}
        if any(rows.values()):
            most = max(rows, key=lambda row: rows[row])
            span = f"{min(rows.values()):.4g} to {rows[most]:.4g} {QUANTITIES[name]}".rstrip()
            lines.append(f"{name.replace('_', ' ')} {span}, largest at {_where(table, most)}")
    return lines


def _where(table: Sweep, row: Row) -> str:
    values = (table.plan.shown(i, value) for i, value in enumerate(row.values))
    return ", ".join(f"{key} = {value}" for key, value in zip(table.plan.keys, values, strict=True))


def _say(table: Sweep, folder: Path, figures: list[Path]) -> None:
    failed = table.failed
    typer.echo(f"{len(table.rows) - len(failed)} of {len(table.rows)} variants have an answer")
    for row in failed[:_SHOWN]:
        typer.echo(f"  {_where(table, row)}: {row.reason}")
    if len(failed) > _SHOWN:
        typer.echo(f"  ... and {len(failed) - _SHOWN} more")
    for line in _ranges(table):
        typer.echo(line)
    for path in (folder / "sweep.csv", *figures):
        typer.echo(path)
