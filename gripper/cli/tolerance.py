"""``gripper tolerance``: within what a summary's numbers lie when the scene's numbers lie within their bands."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, Output, interruptible, output_folder, progress, stop, writing

if TYPE_CHECKING:
    from gripper.bands import Band, Sampled

TABLE = "tolerance.csv"


def tolerance(
    scene_file: Annotated[Path, typer.Argument(metavar="SCENE.toml", help="The scene.", show_default=False)],
    output: Output = None,
    samples: Annotated[
        int, typer.Option(metavar="N", help="Also follow N variants drawn from the bands, N a power of 2.")
    ] = 0,
) -> None:
    """Say by how much the numbers of a scene's table of tolerances change those of its summary.

    Bands are linear, from exact sensitivities: at worst, and likely (the root of the sum of squares). Writes
    tolerance.csv and a tornado chart of each number.

    Exit status: 0; 1 when a pose or a variant has no answer; 2 for bad input; 130 when interrupted.
    """
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    with interruptible("nothing was written"):
        _tolerance(scene_file, output or Path("out", f"{scene_file.stem}_tolerance"), samples)


def _tolerance(scene_file: Path, folder: Path, samples: int) -> None:
    from gripper.bands import linear_bands, sampled_bands
    from gripper.cli.run import solved
    from gripper.scenefile import SceneFileError, read

    drawn: tuple[Sampled, ...] = ()
    reasons: tuple[str, ...] = ()
    try:
        scene = read(scene_file)
        if scene.tolerances is None:
            stop(f"{scene_file}: tolerance: must be given, as [tolerance] with half widths by key", BAD_INPUT)
        with output_folder(folder, [TABLE]):
            with progress() as report:
                result = solved(scene, scene_file, report)
            bands = linear_bands(result)
            if samples:
                drawn, reasons = sampled_bands(scene, samples)
            with writing(folder):
                paths = _written(folder, bands, drawn)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    except ValueError as error:
        stop(" ".join(str(error).split()), BAD_INPUT)
    _say(bands, drawn, samples)
    for reason in reasons[:5]:
        typer.echo(f"no answer: {reason}", err=True)
    for path in paths:
        typer.echo(path)
    if result.failed or reasons:
        raise typer.Exit(FAILED_POSE)


def _say(bands: tuple[Band, ...], drawn: tuple[Sampled, ...], samples: int) -> None:
    """One line a number: its value, how far it may be off, and what counts most."""
    from gripper.results.summary import QUANTITIES

    spread = {band.quantity: band for band in drawn}
    typer.echo(f"{'':24}{'value':>11}{'at worst':>11}{'likely':>11}   what counts most")
    for band in bands:
        most = sorted(zip(band.keys, band.changes, strict=True), key=lambda pair: -abs(pair[1]))[:2]
        what = ", ".join(f"{key} {change:+.2g}" for key, change in most if change)
        numbers = f"{band.value:>11.4g}{f'+-{band.worst:.2g}':>11}{f'+-{band.likely:.2g}':>11}"
        unit = QUANTITIES[band.quantity]
        name = f"{band.quantity.replace('_', ' ')}{unit and f' ({unit})'}"
        typer.echo(f"{name:24}{numbers}   {what}")
        if band.quantity in spread:
            of = spread[band.quantity]
            typer.echo(
                f"{'':24}of {of.samples} samples 95 % from {of.low:.4g} to {of.high:.4g}, all from "
                f"{of.least:.4g} to {of.largest:.4g}"
            )


def _written(folder: Path, bands: tuple[Band, ...], drawn: tuple[Sampled, ...]) -> tuple[Path, ...]:
    import io

    from gripper.output import write_files

    def png(band: Band) -> bytes:
        data = io.BytesIO()
        band.plot().savefig(data, format="png")
        return data.getvalue()

    contents = {TABLE: _table(bands, drawn).encode()} | {f"tornado_{band.quantity}.png": png(band) for band in bands}
    return write_files(folder, contents)


def _table(bands: tuple[Band, ...], drawn: tuple[Sampled, ...]) -> str:
    """One row a number: its value, its bands, and what each tolerance changes."""
    import csv
    import io

    spread = {band.quantity: band for band in drawn}
    keys = bands[0].keys if bands else ()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["samples", "least", "low", "high", "largest"]
    writer.writerow(["quantity", "value", "worst", "likely", *names, *keys])
    for band in bands:
        of = spread.get(band.quantity)
        numbers = [getattr(of, name) if of else None for name in names]
        writer.writerow([band.quantity, band.value, band.worst, band.likely, *numbers, *band.changes])
    return text.getvalue()
