"""Figures of a result: snapshots to scale in the world frame, and the force along the motion.

Figures are made without pyplot: nothing global changes, no display is needed, and a notebook shows them.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from gripper.result import Event, PoseResult, Result
from gripper.sketch import FORCE, INK, SECOND, STRAIN, Box, Key, Sketch, draw, extent, force_unit, handles, sketch

MOST_SNAPSHOTS = 6
WIDTH = 7.2
"""Width of a figure, in inches: a text column."""
_SMALL, _TEXT = 7.0, 9.0


class Picture(Figure):
    """A figure that a notebook shows by itself, whatever backend it has chosen."""

    def _repr_png_(self) -> bytes:
        data = io.BytesIO()
        self.savefig(data, format="png", dpi=150)
        return data.getvalue()


def snapshots(result: Result, poses: Iterable[int] | None = None, ax: Axes | None = None) -> Figure:
    """Draw poses of a motion to one scale: the finger as thick as it is, jaw, object, and the forces on the object.

    Parameters
    ----------
    result
        What to draw.
    poses
        Indices into ``result.poses``; by default up to six spread over the motion, among them its ends, the first
        contact and the largest force.
    ax
        Draw all poses over each other into these axes; by default each beside the other in a new figure.

    Returns
    -------
    The figure, in mm below 1 m; arrows start where finger and object touch; the colour is the bending strain of
    the faces, abs(kappa) w / 2.

    Raises
    ------
    ValueError
        An index out of range, a pose that failed, or no pose to draw.
    """
    chosen = _telling(result.poses) if poses is None else [_checked(result, i) for i in poses]
    if not chosen:
        raise ValueError("poses must hold at least one pose that did not fail; got none")
    drawn = [sketch(result, i) for i in chosen]
    key = Key.of(drawn)
    boxes = [extent(snapshot, key) for snapshot in drawn]
    if ax is None:
        return _filmstrip(result, drawn, boxes, key)
    for level, snapshot in enumerate(drawn):
        draw(ax, snapshot, key, level)
    _frame(ax, _union(boxes), key)
    return _figure(ax)


def pose(result: Result, i: int = 0, ax: Axes | None = None) -> Figure:
    """Draw pose i; as :func:`snapshots`."""
    return snapshots(result, [i], ax)


def curve(result: Result, ax: Axes | None = None) -> Figure:
    """Draw the force on the object (world frame) against the motion's parameter, with the events marked.

    Raises
    ------
    ValueError
        A scene without motion.
    """
    if result.parameter is None:
        raise ValueError("result must hold a motion, of several poses, for a curve; got one pose without motion")
    forces = np.array([each.force_on_object or (np.nan, np.nan) for each in result.poses], dtype=float)
    place = np.array([each.parameter for each in result.poses], dtype=float)
    unit, factor = force_unit(float(np.nanmax(np.hypot(*forces.T))) if np.isfinite(forces).any() else 0.0)
    ax = ax or Picture(figsize=(WIDTH, 0.5 * WIDTH), layout="constrained").subplots()
    for component, name, colour, marker in ((0, "x", SECOND, "o"), (1, "y", FORCE, "s")):
        ax.plot(place, factor * forces[:, component], color=colour, marker=marker, markersize=3, label=f"along {name}")
    failed = [each.parameter for each in result.failed if each.parameter is not None]
    if failed:
        ax.plot(failed, [0.0] * len(failed), "x", color=INK, markersize=6, label="failed")
    _mark(ax, result.events, float(np.ptp(place)))
    ax.axhline(0.0, color=INK, linewidth=0.6)
    ax.set_xlabel(result.parameter, fontsize=_TEXT, parse_math=False)
    ax.set_ylabel(f"force on the object ({unit})", fontsize=_TEXT)
    ax.set_title(_wrapped(result.title), fontsize=_TEXT, parse_math=False)
    ax.tick_params(labelsize=_SMALL)
    ax.legend(fontsize=_SMALL, frameon=False)
    return _figure(ax)


def _figure(ax: Axes) -> Figure:
    figure = ax.get_figure(root=True)
    assert figure is not None, "these axes belong to no figure"
    return figure


def _wrapped(text: str) -> str:
    return textwrap.fill(text, 90)


def _mark(ax: Axes, events: Sequence[Event], span: float) -> None:
    """Mark events by lines; those too near each other for two labels share one."""
    groups: list[list[Event]] = []
    for event in sorted(events, key=lambda each: each.parameter):
        if groups and event.parameter - groups[-1][0].parameter < 0.02 * span:
            groups[-1].append(event)
        else:
            groups.append([event])
    for event in events:
        ax.axvline(event.parameter, color=INK, linewidth=0.8, linestyle=":")
    if groups:
        kinds = [", ".join(dict.fromkeys(event.kind for event in group)) for group in groups]
        names = ax.secondary_xaxis("top")  # above the curves, which they would hide
        names.set_xticks([group[0].parameter for group in groups], kinds, rotation=90, fontsize=_SMALL)


def _checked(result: Result, i: int) -> int:
    if not 0 <= i < len(result.poses):
        raise ValueError(f"poses must hold indices from 0 to {len(result.poses) - 1}; got {i!r}")
    if result.poses[i].shape is None:
        raise ValueError(f"poses must not hold poses that failed; got {i!r}: {result.poses[i].reason}")
    return i


def _telling(poses: Sequence[PoseResult]) -> list[int]:
    """Choose the ends, the first contact, the largest force, and what lies farthest from those already chosen."""
    there = [i for i, each in enumerate(poses) if each.shape is not None]
    if len(there) <= MOST_SNAPSHOTS:
        return there
    touching = [i for i in there if poses[i].contacts]
    largest = max(there, key=lambda i: math.hypot(*(poses[i].force_on_object or (0.0, 0.0))))
    chosen = {there[0], there[-1], largest, *touching[:1]}
    while len(chosen) < MOST_SNAPSHOTS:
        chosen.add(max(there, key=lambda i: min(abs(i - other) for other in chosen)))
    return sorted(chosen)


def _union(boxes: Sequence[Box]) -> Box:
    left, bottom, right, top = zip(*boxes, strict=True)
    return min(left), min(bottom), max(right), max(top)


def _windows(boxes: Sequence[Box]) -> list[Box]:
    """One window for all panels where little is wasted; else each its own, of one size, so that the scale is one."""
    sizes = [(right - left, top - bottom) for left, bottom, right, top in boxes]
    width, height = (max(size) for size in zip(*sizes, strict=True))
    everything = _union(boxes)
    if (everything[2] - everything[0]) * (everything[3] - everything[1]) < 1.4 * width * height:
        return [everything] * len(boxes)
    centres = [((left + right) / 2, (bottom + top) / 2) for left, bottom, right, top in boxes]
    return [(x - width / 2, y - height / 2, x + width / 2, y + height / 2) for x, y in centres]


def _grid(n: int, aspect: float) -> tuple[int, int]:
    """Rows and columns for n panels of this height by width: large panels, few empty places, no taller than wide."""

    def rows(columns: int) -> int:
        return math.ceil(n / columns)

    fitting = [columns for columns in range(1, n + 1) if rows(columns) * aspect / columns <= 0.9] or [n]
    best = max(fitting, key=lambda columns: n / columns**2 / rows(columns))
    return rows(best), best


def _filmstrip(result: Result, drawn: Sequence[Sketch], boxes: Sequence[Box], key: Key) -> Figure:
    windows = _windows(boxes)
    aspect = (windows[0][3] - windows[0][1]) / (windows[0][2] - windows[0][0])
    rows, columns = _grid(len(drawn), aspect)
    panel = min(WIDTH / columns - 0.45, 0.65 * WIDTH / aspect)  # the labels take the rest
    spare = rows * columns > len(drawn)
    height = rows * (panel * aspect + 0.5) + (0.6 if spare else 1.2)
    figure = Picture(figsize=(WIDTH, height), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False).ravel().tolist()
    for ax, snapshot, window in zip(panels, drawn, windows, strict=False):
        draw(ax, snapshot, key)
        _frame(ax, window, key)
        ax.set_title(_caption(result.parameter, snapshot.pose, key), fontsize=_TEXT, parse_math=False)
    for ax in panels[len(drawn) :]:
        ax.axis("off")
    figure.suptitle(_wrapped(result.title), fontsize=_TEXT + 1, parse_math=False)
    if spare:
        _legend_in(panels[-1], key)
    else:
        _legend_below(figure, panels, key)
    return figure


def _caption(parameter: str | None, answer: PoseResult, key: Key) -> str:
    unit, factor = key.force
    force = f"{factor * math.hypot(*answer.force_on_object):.3g} {unit}" if answer.force_on_object else ""
    said = force if answer.status == "contact" else answer.status
    return f"{parameter} = {answer.parameter:.4g}: {said}" if parameter else said


def _legend_in(ax: Axes, key: Key) -> None:
    """Put colours and marks into a panel that holds no pose."""
    place = ax.inset_axes((0.05, 0.7, 0.9, 0.07))
    ax.figure.colorbar(ScalarMappable(key.strain, STRAIN), cax=place, orientation="horizontal")
    _label_colours(place)
    if key.arrow:
        ax.legend(handles=handles(key), loc="upper center", bbox_to_anchor=(0.5, 0.4), fontsize=_SMALL, frameon=False)


def _legend_below(figure: Figure, panels: list[Axes], key: Key) -> None:
    """Put colours and marks under all panels."""
    colours = ScalarMappable(key.strain, STRAIN)
    bar = figure.colorbar(colours, ax=panels, location="bottom", shrink=0.5, aspect=45, pad=0.02)
    _label_colours(bar.ax)
    if key.arrow:
        figure.legend(handles=handles(key), loc="outside lower center", ncols=2, fontsize=_SMALL, frameon=False)


def _label_colours(ax: Axes) -> None:
    ax.set_xlabel("bending strain of the faces (%)", fontsize=_SMALL)
    ax.tick_params(labelsize=_SMALL)


def _frame(ax: Axes, window: Box, key: Key) -> None:
    unit, factor = key.length
    left, bottom, right, top = (factor * side for side in window)
    ax.set_xlim(left, right)
    ax.set_ylim(bottom, top)
    ax.set_aspect("equal")
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    ax.tick_params(labelsize=_SMALL)
    ax.set_xlabel(f"x ({unit})", fontsize=_SMALL)
    ax.set_ylabel(f"y ({unit})", fontsize=_SMALL)
    ax.label_outer(remove_inner_ticks=False)
    ax.tick_params(labelbottom=True, labelleft=True)  # the windows may differ from panel to panel
