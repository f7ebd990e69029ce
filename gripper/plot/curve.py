"""Any number of a result along its motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from gripper.plot.layout import Row, arrange
from gripper.plot.quantity import Series, gather
from gripper.plot.style import FORCE, INCH, INK, PAGE, SECOND, THIRD, Picture, figure_of, styled
from gripper.result import Event, Result

_WAYS: tuple[Any, Any] = ("-", (0, (4, 2)))
"""Lines of the way there, and of the way back."""
_MARKS = 8.5
"""Poses that are marked on a line, at most about, an inch of the figure's width."""
_LABEL = 0.7
"""Room for the name of an event, in inches."""


def curve(result: Result, quantity: str = "force_on_object", *, width: float = PAGE, ax: Axes | None = None) -> Figure:
    """Draw a number of a result against the motion's parameter, with the events marked.

    A way back is dashed, a snap breaks the line, poses where a contact sticks have hollow marks, and those without an
    answer are crosses.

    Parameters
    ----------
    result
        A motion.
    quantity
        Its name in ``result.poses``, one of ``QUANTITIES``: the force on the object (world frame), by default.
    width
        Of the figure, in m: ``gripper.plot.PAGE`` by default, or ``gripper.plot.COLUMN``.
    ax
        Draw into these axes, without events and title.

    Returns
    -------
    The figure.

    Raises
    ------
    ValueError
        A scene without motion.
    LookupError
        An unknown quantity.
    """
    scales, (series,) = gather([result], quantity)
    with styled():
        if ax is None:
            figure = Picture(figsize=(width / INCH, width / INCH))
            given = figure.add_axes((0.1, 0.1, 0.8, 0.4))
        else:
            given = ax
        colours = [SECOND, FORCE] if len(scales.components) > 1 else [THIRD]
        for i, (part, colour, mark) in enumerate(zip(scales.components, colours, "os", strict=False)):
            _draw_line(given, series, i, {"color": colour, "marker": mark}).set_label(part or "_")
        _draw_unanswered(given, series)
        given.axhline(0.0, color=INK, linewidth=0.6, zorder=0.5)
        given.set_xlabel(scales.x, parse_math=False)
        given.set_ylabel(scales.y, parse_math=False)
        _explain(given, series)
        if ax is not None:
            return figure_of(ax)
        _mark(given, result.events, scales.along.factor)
        arrange(figure, [Row([given], inches=max(0.35 * width / INCH, 1.6))], result.title)
        return figure


def _draw_line(ax: Axes, series: Series, component: int, look: dict[str, Any]) -> Line2D:
    """Draw one component: solid up to the first turning of the motion, dashed from there, broken at snaps."""
    lines, most = [], _MARKS * figure_of(ax).get_figwidth()
    for i, (x, y) in enumerate(series.ways(component)):
        lines += ax.plot(x, y, **look, markevery=math.ceil(len(x) / most), linestyle=_WAYS[i % 2])
    held = series.sticking
    if held.any():
        hollow = {**look, "color": "white", "markeredgecolor": look["color"]}
        ax.plot(series.place[held], series.values[held, component], **hollow, linewidth=0, zorder=3)
    return lines[0]


def _draw_unanswered(ax: Axes, series: Series) -> None:
    for status, mark in (("failed", "x"), ("locked", "v")):
        there = [x for x, pose in zip(series.place, series.result.poses, strict=True) if pose.status == status]
        if there:
            ax.plot(there, [0.0] * len(there), mark, color=INK, markersize=5, label=status)


def _explain(ax: Axes, series: Series) -> None:
    """Make a legend, where there is more than one kind of line or mark."""
    entries, names = ax.get_legend_handles_labels()
    if series.turns:
        entries += [Line2D([], [], color=INK, linestyle=way) for way in _WAYS]
        names += ["way there", "way back"]
    if series.sticking.any():
        entries.append(Line2D([], [], color="white", markeredgecolor=INK, marker="o", linewidth=0))
        names.append("sticks")
    if entries:
        ax.legend(entries, names)


def _mark(ax: Axes, events: Sequence[Event], factor: float) -> None:
    """Mark events by lines; those too near each other for two labels share one."""
    left, right = ax.get_xlim()
    groups: list[list[Event]] = []
    for event in sorted(events, key=lambda each: each.parameter):
        if groups and factor * (event.parameter - groups[-1][0].parameter) < 0.025 * abs(right - left):
            groups[-1].append(event)
        else:
            groups.append([event])
    for event in events:
        ax.axvline(factor * event.parameter, color=INK, linewidth=0.6, linestyle=":", zorder=0.6)
    if groups:
        kinds = [", ".join(dict.fromkeys(event.kind for event in group)) for group in groups]
        places = [factor * group[0].parameter for group in groups]
        room = min((b - a for a, b in pairwise(places)), default=np.inf) / abs(right - left)
        names = ax.secondary_xaxis("top")  # above the curves, which they would hide
        names.set_xticks(places, kinds, rotation=0 if room * figure_of(ax).get_figwidth() > _LABEL else 90)
