"""Snapshots of a motion to one scale, each beside the other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from gripper.plot.draw import Key, draw, frame
from gripper.plot.layout import KEY_WIDTH, Legend, Row, arrange
from gripper.plot.panel import Panel
from gripper.plot.sketch import Axis, Box, union
from gripper.plot.style import COLUMN, INCH, PAGE, Picture, figure_of, styled
from gripper.result import PoseResult, Result

MOST_SNAPSHOTS = 6
_LEAST = 1.5
"""Least width of a panel with its labels, in inches."""
_NARROW = 1.9
"""Panels narrower than this, in inches, break their captions."""
_LABELS = 0.5
"""Room that the labels left of all panels need, in inches, about."""


def filmstrip(
    result: Result,
    poses: Iterable[int] | Mapping[int, str] | None = None,
    *,
    mirror: Axis | None = None,
    width: float | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Draw poses of a motion to one scale: the finger as thick as it is, jaw, object, and the forces on the object.

    Parameters
    ----------
    result
        What to draw.
    poses
        Indices into ``result.poses``, with or without a name each: ``{4: "insertion", ...}``; by default up to six
        spread over the motion, among them its ends, the first contact and the largest force.
    mirror
        An axis of the object's symmetry, as x, y (m) and angle (rad) in the world, beyond which a second finger is
        drawn; None for none.
    width
        Of the figure, in m: ``gripper.plot.PAGE`` by default, ``gripper.plot.COLUMN`` for a single pose.
    ax
        Draw all poses over each other into these axes, instead of each beside the other in a new figure.

    Returns
    -------
    The figure, in mm below 1 m; arrows start where finger and object touch; the colour is the bending strain of
    the faces, abs(kappa) w / 2.

    Raises
    ------
    ValueError
        An index out of range, a pose without an answer, no pose to draw, or an axis that is not the object's.
    """
    chosen = _telling(result.poses) if poses is None else [_checked(result, i) for i in poses]
    if not chosen:
        raise ValueError("poses must hold at least one pose that has an answer; got none")
    names = poses if isinstance(poses, Mapping) else {}
    panels = [Panel.of(result, i, names.get(i, ""), mirror) for i in chosen]
    with styled():
        return _strip(panels, result.title, width) if ax is None else _over_each_other(panels, ax)


def beside(results: Mapping[str, Result], *, title: str = "", width: float | None = None) -> Figure:
    """Draw scenes of one pose beside each other, to one scale.

    Parameters
    ----------
    results
        Each result by its name.
    title, width
        Of the figure; the width in m, ``gripper.plot.PAGE`` by default.

    Returns
    -------
    The figure, as :func:`filmstrip`.

    Raises
    ------
    ValueError
        No result, or one of several poses or without an answer.
    """
    panels = [Panel.of(result, result.poses.index(result.pose), name) for name, result in results.items()]
    if not panels:
        raise ValueError("results must hold at least one result; got none")
    with styled():
        return _strip(panels, title, width)


def _checked(result: Result, i: int) -> int:
    if not 0 <= i < len(result.poses):
        raise ValueError(f"poses must hold indices from 0 to {len(result.poses) - 1}; got {i!r}")
    if result.poses[i].shape is None:
        raise ValueError(f"poses must hold poses that have an answer; got {i!r}: {result.poses[i].reason}")
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


def _windows(boxes: Sequence[Box]) -> list[Box]:
    """One window for all panels where little is wasted; else each its own, of one size, so that the scale is one."""
    sizes = [(right - left, top - bottom) for left, bottom, right, top in boxes]
    width, height = (max(size) for size in zip(*sizes, strict=True))
    everything = union(boxes)
    if (everything[2] - everything[0]) * (everything[3] - everything[1]) < 1.4 * width * height:
        return [everything] * len(boxes)
    centres = [((left + right) / 2, (bottom + top) / 2) for left, bottom, right, top in boxes]
    return [(x - width / 2, y - height / 2, x + width / 2, y + height / 2) for x, y in centres]


def _grid(n: int, aspect: float, width: float) -> tuple[int, int]:
    """Rows and columns for n panels of this height by width: not too small, few empty places, no taller than a page."""

    def rows(columns: int) -> int:
        return math.ceil(n / columns)

    most = max(1, int(width / _LEAST))
    fitting = [columns for columns in range(1, min(n, most) + 1) if rows(columns) * aspect / columns <= 0.8]
    best = max(fitting or [min(n, most)], key=lambda columns: n / columns**2 / rows(columns))
    return rows(best), best


def _strip(panels: Sequence[Panel], title: str, width: float | None) -> Figure:
    key = Key.of([panel.fingers for panel in panels])
    windows = _windows([panel.extent(key) for panel in panels])
    aspect = (windows[0][3] - windows[0][1]) / (windows[0][2] - windows[0][0])
    inches = (width or (COLUMN if len(panels) == 1 else PAGE)) / INCH
    rows, columns = _grid(len(panels), aspect, inches)
    figure = Picture(figsize=(inches, inches))
    places = [figure.add_axes((0.1, 0.1, 0.8 / columns, 0.5), label=str(i)) for i in range(len(panels))]
    narrow = inches / columns < _NARROW
    _fill(places, panels, windows, key, columns, ticks=3 if narrow else 5)
    for ax, panel in zip(places, panels, strict=True):
        caption = panel.caption(key)
        ax.set_title(caption.replace(": ", ":\n") if narrow else caption, parse_math=False)
    spare = rows * columns - len(panels)
    if (inches - _LABELS) * spare / columns < KEY_WIDTH:
        spare = 0
    legend = Legend(figure, key, KEY_WIDTH if spare else 0.94 * inches)
    lines = [Row(places[i : i + columns], aspect) for i in range(0, len(places), columns)]
    arrange(figure, lines, title, legend, after=rows - 1, spare=spare)
    return figure


def _fill(
    places: Sequence[Axes], panels: Sequence[Panel], windows: Sequence[Box], key: Key, columns: int, ticks: int
) -> None:
    """Draw the panels; labels stand at the outer ones, numbers also inside where the windows differ."""
    differ = windows[0] is not windows[-1]
    for i, (ax, panel, window) in enumerate(zip(places, panels, windows, strict=True)):
        for each in panel.fingers:
            draw(ax, each, key)
        frame(ax, window, key, ticks=ticks)
        first, lowest = i % columns == 0, i + columns >= len(places)
        ax.tick_params(labelleft=first or differ, labelbottom=lowest or differ)
        ax.yaxis.label.set_visible(first)
        ax.xaxis.label.set_visible(lowest)


def _over_each_other(panels: Sequence[Panel], ax: Axes) -> Figure:
    key = Key.of([panel.fingers for panel in panels])
    for level, panel in enumerate(panels):
        for each in panel.fingers:
            draw(ax, each, key, level)
    frame(ax, union([panel.extent(key) for panel in panels]), key)
    return figure_of(ax)
