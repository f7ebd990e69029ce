"""What else loads a finger, on paper: arrows that end where it acts. They tell where to, not how much."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch
from matplotlib.patheffects import withStroke

from gripper.plot.style import SECOND
from gripper.results.pose_result import Applied

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

LONG = 0.12
"""Of the finger's length: a force's arrow; a moment's has a third of it as its radius."""
_BOW = 0.9
_MOMENT = 1e-6  # of a moment over the finger's length: a force this small is none


class Pull(NamedTuple):
    """A load on paper: the point (2,) where it acts, its unit direction (2,), 0 of a moment; the sign of a moment."""

    point: Array
    direction: Array
    turn: float


def pulls(applied: tuple[Applied, ...], size: float) -> list[Pull]:
    """What is drawn of a pose's loads, on a finger of this size (m); nothing of those that are 0."""
    out = []
    for each in applied:
        force = np.array(each.force)
        strength = float(np.hypot(*force))
        if strength > _MOMENT * abs(each.moment) / size:
            out.append(Pull(np.array(each.point), force / strength, 0.0))
        elif each.moment:
            out.append(Pull(np.array(each.point), np.zeros(2), float(np.sign(each.moment))))
    return out


def reach(pull: Pull, size: float) -> Array:
    """Give points (n, 2) that a drawn load needs room for, in m."""
    if pull.turn:
        return np.asarray(pull.point + LONG / 3 * size * np.array([[1.0, 1.0], [-1.0, -1.0]]))
    return np.asarray(pull.point - LONG * size * pull.direction)[np.newaxis]


def draw_load(ax: Axes, pull: Pull, size: float, factor: float) -> Artist:
    """Draw a load on a finger of this size (m), in the unit of the factor."""
    ends, bow = [pull.point - LONG * size * pull.direction, pull.point], 0.0
    if pull.turn:
        half = LONG / 3 * size * np.array([0.5, np.sqrt(0.75)])
        ends, bow = [pull.point + half * (1, -pull.turn), pull.point + half * (1, pull.turn)], _BOW * pull.turn
    style: dict[str, Any] = {
        "arrowstyle": "-|>",
        "mutation_scale": 7.0,
        "linewidth": 1.3,
        "color": SECOND,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    arrow = FancyArrowPatch(*(tuple(factor * end) for end in ends), connectionstyle=f"arc3,rad={bow}", **style)
    arrow.set_zorder(1e3)
    arrow.set_path_effects([withStroke(linewidth=2.4, foreground="white")])
    return ax.add_patch(arrow)


def handle() -> Artist:
    """Give the entry of a legend."""
    return Line2D([], [], color=SECOND, marker=">", linewidth=1.3, markersize=4, label="load (not to scale)")
