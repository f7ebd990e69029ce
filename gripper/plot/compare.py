"""Lines over each other: a number of several results, and plain numbers, in the figures' one style."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from itertools import cycle, pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gripper.plot.layout import Row, arrange
from gripper.plot.quantity import Array, gather
from gripper.plot.style import COLUMN, FORCE, FOURTH, INCH, INK, PAGE, SECOND, THIRD, Picture, styled
from gripper.result import Result

Line = tuple[Sequence[float] | Array, Sequence[float] | Array]
_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": SECOND, "linestyle": "-"},
    {"color": FORCE, "linestyle": "--"},
    {"color": THIRD, "linestyle": ":"},
    {"color": FOURTH, "linestyle": "-."},
)
"""Lines that differ in a print without colours too."""
_LABEL = 36
"""Letters in a line of a label that stands beside a panel."""
_LEAST = 2.5
"""Width, in inches, that a panel needs beside another; narrower ones stand under each other."""


def compare(
    results: Mapping[str, Result],
    quantity: str = "force_on_object",
    *,
    points: Mapping[str, Sequence[tuple[float, Sequence[float] | float]]] | None = None,
    levels: Mapping[str, float] | None = None,
    title: str = "",
    width: float = PAGE,
) -> Figure:
    """Draw a number of several motions over each other, in a panel for each of its components.

    Lines are broken at snaps; the ground is grey where a contact of the first motion sticks.

    Parameters
    ----------
    results
        Motions of one parameter, by name.
    quantity
        Its name in ``result.poses``, one of ``QUANTITIES``.
    points
        Numbers from elsewhere, by name: values of the parameter, each with the number or its components (SI).
    levels
        Numbers that hold everywhere, by name (SI).
    title, width
        Of the figure; the width in m.

    Returns
    -------
    The figure.

    Raises
    ------
    ValueError
        No result, or a scene without motion.
    LookupError
        An unknown quantity.
    """
    if not results:
        raise ValueError("results must hold at least one result; got none")
    scales, series = gather(list(results.values()), quantity)
    along, across = scales.along.factor, scales.across.factor
    with styled():
        figure, axes = _axes(len(scales.components), width)
        for i, (ax, label) in enumerate(zip(axes, scales.components.values(), strict=True)):
            for (name, each), look in zip(zip(results, series, strict=True), cycle(_LOOKS)):
                for k, (x, y) in enumerate(each.ways(i)):
                    ax.plot(x, y, **look, label="" if k else name)
            for name, given in (points or {}).items():
                numbers = [across * float(np.atleast_1d(value)[i]) for _, value in given]
                _scatter(ax, name, ([along * at for at, _ in given], numbers))
            _level(ax, {name: across * value for name, value in (levels or {}).items()})
            for begin, end in sticks(next(iter(results.values()))):
                ax.axvspan(along * begin, along * end, color="0.8", linewidth=0, label="sticks")
            ax.set_xlabel(scales.x, parse_math=False)
            ax.set_ylabel(textwrap.fill(label, _LABEL), parse_math=False)
        return _finished(figure, axes, title, width)


def chart(
    lines: Mapping[str, Line],
    x: str,
    y: str,
    *,
    levels: Mapping[str, float] | None = None,
    title: str = "",
    width: float = COLUMN,
) -> Figure:
    """Draw plain numbers as lines with marks.

    Parameters
    ----------
    lines
        Numbers across and up, by name.
    x, y
        What the axes are called, with units.
    levels
        Numbers that hold everywhere, by name.
    title, width
        Of the figure; the width in m.

    Returns
    -------
    The figure.
    """
    with styled():
        figure, axes = _axes(1, width)
        for (name, line), look, mark in zip(lines.items(), cycle(_LOOKS), cycle("os^D")):
            axes[0].plot(*line, marker=mark, label=name, **look)
        _level(axes[0], levels or {})
        axes[0].set_xlabel(x, parse_math=False)
        axes[0].set_ylabel(y, parse_math=False)
        return _finished(figure, axes, title, width)


def sticks(result: Result) -> list[tuple[float, float]]:
    """Where along the motion a contact comes to stick, and where it slips again."""
    changes = [event for event in result.events if event.kind in ("stick", "slip")]
    return [(a.parameter, b.parameter) for a, b in pairwise(changes) if (a.kind, b.kind) == ("stick", "slip")]


def _axes(number: int, width: float) -> tuple[Figure, list[Axes]]:
    figure = Picture(figsize=(width / INCH, width / INCH))
    places = [(0.1 + 0.9 * i / number, 0.1, 0.8 / number, 0.4) for i in range(number)]
    return figure, [figure.add_axes(place, label=str(i)) for i, place in enumerate(places)]


def _scatter(ax: Axes, name: str, line: Line) -> None:
    ax.plot(*line, "o", color=INK, markerfacecolor="none", label=name, zorder=3)


def _level(ax: Axes, levels: Mapping[str, float]) -> None:
    for (name, value), dashes in zip(levels.items(), cycle(("--", ":"))):
        ax.axhline(value, color=INK, linestyle=dashes, zorder=0.9, label=name)


def _finished(figure: Figure, axes: Sequence[Axes], title: str, width: float) -> Figure:
    """Make the legend, where there is more than one line, and give all their places."""
    entries, names = axes[-1].get_legend_handles_labels()
    if len(entries) > 1:
        axes[-1].legend(entries, names)
    beside = width / INCH > _LEAST * len(axes)
    inches = max(0.35 * width / INCH, 2.0)
    arrange(figure, [Row(row, inches=inches) for row in ([axes] if beside else [[ax] for ax in axes])], title)
    return figure
