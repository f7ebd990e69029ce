"""``gripper tolerance``: within what a summary's numbers lie when the scene's numbers lie within their bands."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gripper.cli.console import BAD_INPUT, FAILED_POSE, Output, interruptible, output_folder, progress, stop, writing

if TYPE_CHECKING:
    from gripper.bands import Band, Sampled
    from gripper.result import Result
    from gripper.results.summary import Summary

TABLE = "tolerance.csv"
NEGLIGIBLE = 1e-7
"""Of the largest number of the same unit: below it a number is round-off."""


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
    from gripper.bands import sampled_bands
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
            bands = _linear(result, samples, scene_file)
            if samples:
                drawn, reasons = sampled_bands(scene, samples)
            with writing(folder):
                paths = _written(folder, result.summary(), bands, drawn)
    except SceneFileError as error:
        stop(str(error), BAD_INPUT)
    except ValueError as error:
        stop(" ".join(str(error).split()), BAD_INPUT)
    _say(result.summary(), bands, drawn)
    for reason in reasons[:5]:
        typer.echo(f"no answer: {reason}", err=True)
    if len(reasons) > 5:
        typer.echo(f"no answer: {len(reasons) - 5} more of {samples} samples", err=True)
    for path in paths:
        typer.echo(path)
    if result.failed or reasons:
        raise typer.Exit(FAILED_POSE)


def _linear(result: Result, samples: int, scene_file: Path) -> tuple[Band, ...]:
    """Linear bands; none, and why, where a scene has no derivatives and samples are drawn."""
    from gripper.bands import linear_bands

    try:
        return linear_bands(result)
    except ValueError as error:
        said = " ".join(str(error).split())
        if not samples:
            stop(f"{scene_file}: {said} (--samples 256 needs no derivatives)", BAD_INPUT)
        typer.echo(f"no linear bands: {said}", err=True)
        return ()


def _say(summary: Summary, bands: tuple[Band, ...], drawn: tuple[Sampled, ...]) -> None:
    """One line a number: its value, how far it may be off, and what counts most."""
    linear, spread = {band.quantity: band for band in bands}, {of.quantity: of for of in drawn}
    head = f"{'at worst':>11}{'likely':>11}   what counts most" if bands else ""
    typer.echo(f"{'':24}{'value':>11}{head}")
    for quantity, unit in _rows(summary, bands, drawn).items():
        name = f"{quantity.replace('_', ' ')}{unit and f' ({unit})'}"
        value = getattr(summary, quantity)
        typer.echo(f"{name:24}{'' if value is None else f'{value:.4g}':>11}{_effect(linear.get(quantity))}")
        if quantity in spread:
            of = spread[quantity]
            typer.echo(
                f"{'':24}of {of.samples} samples 95 % from {of.low:.4g} to {of.high:.4g}, all from "
                f"{of.least:.4g} to {of.largest:.4g}"
            )


def _rows(summary: Summary, bands: tuple[Band, ...], drawn: tuple[Sampled, ...]) -> dict[str, str]:
    """The quantities that have a band, with their units; without those that are 0 but for round-off."""
    from gripper.results.summary import QUANTITIES

    largest = {band.quantity: abs(band.value) + band.worst for band in bands}
    for of in drawn:
        largest[of.quantity] = max(largest.get(of.quantity, 0.0), abs(of.least), abs(of.largest))
    scales = {"": 1.0}  # of each unit: of a force, the largest force
    for quantity, unit in QUANTITIES.items():
        scales[unit] = max(scales.get(unit, 0.0), abs(getattr(summary, quantity) or 0.0))
    return {q: unit for q, unit in QUANTITIES.items() if largest.get(q, 0.0) > NEGLIGIBLE * scales[unit]}


def _effect(band: Band | None) -> str:
    if band is None:
        return ""
    most = sorted(zip(band.keys, band.changes, strict=True), key=lambda pair: -abs(pair[1]))[:2]
    what = ", ".join(f"{key} {change:+.2g}" for key, change in most if change)
    return f"{f'+-{band.worst:.2g}':>11}{f'+-{band.likely:.2g}':>11}   {what}"


def _written(folder: Path, summary: Summary, bands: tuple[Band, ...], drawn: tuple[Sampled, ...]) -> tuple[Path, ...]:
    import io

    from gripper.output import write_files

    def png(band: Band) -> bytes:
        data = io.BytesIO()
        band.plot().savefig(data, format="png")
        return data.getvalue()

    charts = {f"tornado_{band.quantity}.png": png(band) for band in bands}
    return write_files(folder, {TABLE: _table(summary, bands, drawn).encode()} | charts)


def _table(summary: Summary, bands: tuple[Band, ...], drawn: tuple[Sampled, ...]) -> str:
    """One row a number: its value, its bands, and what each tolerance changes."""
    import csv
    import io

    linear, spread = {band.quantity: band for band in bands}, {of.quantity: of for of in drawn}
    keys = bands[0].keys if bands else ()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["samples", "least", "low", "high", "largest"]
    writer.writerow(["quantity", "value", "worst", "likely", *names, *keys])
    for quantity in _rows(summary, bands, drawn):
        band, of = linear.get(quantity), spread.get(quantity)
        widths = [band.worst, band.likely] if band else [None, None]
        numbers = [getattr(of, name) if of else None for name in names]
        changes = band.changes if band else [None] * len(keys)
        writer.writerow([quantity, getattr(summary, quantity), *widths, *numbers, *changes])
    return text.getvalue()
