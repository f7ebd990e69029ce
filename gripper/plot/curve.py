"""Any number of a result along its motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from gripper.plot.layout import Row, arrange
from gripper.plot.style import FORCE, INCH, INK, PAGE, SECOND, THIRD, Picture, figure_of, styled
from gripper.plot.units import Unit, force_unit, labelled, length_unit, parameter_unit
from gripper.result import Event, Result

Array = NDArray[np.float64]

_WAYS: tuple[Any, Any] = ("-", (0, (4, 2)))
"""Lines of the way there, and of the way back."""
_MARKS = 60
"""Poses that are marked on a line, at most about."""

_LABEL = 0.7
"""Room for the name of an event, in inches."""


@dataclass(frozen=True)
class Quantity:
    """What can be drawn: its name on the axis, the names of its components, and its unit for the largest value."""

    name: str
    unit: Callable[[float], Unit]
    components: tuple[str, ...] = ("",)


def _fixed(name: str, factor: float = 1.0) -> Callable[[float], Unit]:
    return lambda largest: Unit(name, factor)


def _energy(largest: float) -> Unit:
    return Unit("J", 1.0) if largest >= 0.1 or largest == 0 else Unit("mJ", 1e3)


def _moment(largest: float) -> Unit:
    return Unit("N m", 1.0) if largest >= 0.1 or largest == 0 else Unit("N mm", 1e3)


_DRIVING = {"deg": ("driving moment", Unit("N m", 1.0)), "": ("driving work", Unit("J", 1.0))}
"""Work to put in per unit of a parameter that is no length: its name and unit."""
QUANTITIES = {
    "force_on_object": Quantity("force on the object", force_unit, ("along x", "along y")),
    "force_on_object_finger_frame": Quantity("force on the object, finger frame", force_unit, ("along x", "along y")),
    "moment_on_object": Quantity("moment on the object", _moment),
    "motion_force": Quantity("driving force", force_unit),
    "clamp_moment": Quantity("clamp moment", _moment),
    "energy": Quantity("strain energy", _energy),
    "tip": Quantity("tip", length_unit, ("x", "y")),
    "tip_rotation": Quantity("rotation of the tip", _fixed("deg", 180 / np.pi)),
    "max_strain": Quantity("largest strain", _fixed("%", 100.0)),
    "min_gap": Quantity("smallest gap", length_unit),
}
"""What :func:`curve` draws, by its name in a result."""


def curve(
    result: Result,
    quantity: str = "force_on_object",
    *,
    label: str = "",
    width: float = PAGE,
    ax: Axes | None = None,
) -> Figure:
    """Draw a number of a result against the motion's parameter, with the events marked.

    A way back is dashed, a snap breaks the line, poses where a contact sticks have hollow marks, and those without an
    answer are crosses.

    Parameters
    ----------
    result
        A motion.
    quantity
        Its name in ``result.poses``, one of ``QUANTITIES``: the force on the object (world frame), by default.
    label
        What to call it in the legend.
    width
        Of the figure, in m: ``gripper.plot.PAGE`` by default, or ``gripper.plot.COLUMN``.
    ax
        Draw into these axes, without events and title, in their next colours: for curves over each other.

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
    if quantity not in QUANTITIES:
        raise LookupError(f"unknown quantity {quantity!r}; known: {', '.join(QUANTITIES)}")
    if result.scene.motion is None:
        raise ValueError("result must hold a motion, of several poses, for a curve; got one pose without motion")
    with styled():
        if ax is not None:
            _draw(ax, result, quantity, label, [None] * 2)
            return figure_of(ax)
        figure = Picture(figsize=(width / INCH, width / INCH))
        ax = figure.add_axes((0.1, 0.1, 0.8, 0.4))
        colours = [SECOND, FORCE] if len(QUANTITIES[quantity].components) > 1 else [THIRD]
        _draw(ax, result, quantity, label, colours)
        _mark(ax, result.events, parameter_unit(result.scene).factor)
        arrange(figure, [Row([ax], inches=max(0.35 * width / INCH, 1.6))], result.title)
        return figure


def _draw(ax: Axes, result: Result, quantity: str, label: str, colours: Sequence[str | None]) -> None:
    what, along = QUANTITIES[quantity], parameter_unit(result.scene)
    place = along.factor * np.array([each.parameter for each in result.poses], dtype=float)
    values = _values(result, quantity, len(what.components))
    known = np.abs(values[np.isfinite(values)])
    unit = what.unit(float(known.max(initial=0.0)))
    name = what.name
    if quantity == "motion_force":
        name, unit = _DRIVING.get(along.name, (name, unit))
        name += f" along {result.parameter}"
    for component, part, colour, mark in zip(values.T, what.components, colours, "os", strict=False):
        look = {"color": colour, "marker": mark}
        line = _draw_line(ax, result, place, unit.factor * component, look)
        line.set_label(", ".join(text for text in (label, part) if text) or "_")
    _draw_unanswered(ax, result, place)
    ax.axhline(0.0, color=INK, linewidth=0.6, zorder=0.5)
    ax.set_xlabel(labelled(result.parameter or "", along), parse_math=False)
    ax.set_ylabel(labelled(name, unit), parse_math=False)
    _explain(ax, result, place)


def _values(result: Result, quantity: str, components: int) -> Array:
    """Give the number at every pose, (n, components); NaN where there is none."""
    none = (np.nan,) * components
    values = [getattr(pose, quantity) for pose in result.poses]
    return np.array([none if value is None else np.atleast_1d(value) for value in values], dtype=float)


def _draw_line(ax: Axes, result: Result, place: Array, values: Array, look: dict[str, Any]) -> Line2D:
    """Draw one component: solid up to the first turning of the motion, dashed from there, broken at snaps."""
    ends = [0, *_turns(place), len(place) - 1]
    snaps = _snaps(result)
    lines = []
    for i, (first, last) in enumerate(pairwise(ends)):
        cuts = [j + 1 - first for j in snaps if first <= j < last]
        x, y = (np.insert(each[first : last + 1], cuts, np.nan) for each in (place, values))
        lines += ax.plot(x, y, **look, markevery=max(1, len(x) // _MARKS), linestyle=_WAYS[i % 2])
        look = {**look, "color": lines[0].get_color()}
    held = _sticking(result)
    if held.any():
        hollow = {"color": "white", "markeredgecolor": lines[0].get_color(), "marker": look["marker"]}
        ax.plot(place[held], values[held], **hollow, linewidth=0, zorder=3)
    return lines[0]


def _sticking(result: Result) -> NDArray[np.bool_]:
    return np.array([any(c.state == "stick" for c in pose.contacts) for pose in result.poses])


def _turns(place: Array) -> list[int]:
    """Indices of the poses at which the motion turns back."""
    steps = np.sign(np.diff(place))
    return [i + 1 for i in range(len(steps) - 1) if steps[i] * steps[i + 1] < 0]


def _snaps(result: Result) -> list[int]:
    """Indices of the poses after which, before the next, the finger snaps. Events stand in the motion's order."""
    place = [float(pose.parameter or 0.0) for pose in result.poses]
    found, i = [], 0
    for event in result.events:
        while i < len(place) - 2 and not min(place[i : i + 2]) <= event.parameter <= max(place[i : i + 2]):
            i += 1
        if event.kind == "snap":
            found.append(i)
    return found


def _draw_unanswered(ax: Axes, result: Result, place: Array) -> None:
    for status, mark in (("failed", "x"), ("locked", "v")):
        there = [x for x, pose in zip(place, result.poses, strict=True) if pose.status == status]
        if there:
            ax.plot(there, [0.0] * len(there), mark, color=INK, markersize=5, label=status)


def _explain(ax: Axes, result: Result, place: Array) -> None:
    """Make a legend, where there is more than one kind of line or mark."""
    entries, names = ax.get_legend_handles_labels()
    if _turns(place):
        entries += [Line2D([], [], color=INK, linestyle=way) for way in _WAYS]
        names += ["way there", "way back"]
    if _sticking(result).any():
        entries.append(Line2D([], [], color="white", markeredgecolor=INK, marker="o", linewidth=0))
        names.append("sticks")
    unique = dict(zip(names, entries, strict=True))  # one entry a name, also where curves lie over each other
    if unique:
        ax.legend(unique.values(), unique.keys())


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
