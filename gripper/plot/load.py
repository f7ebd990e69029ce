"""What else loads a finger, on paper: arrows that end where it acts. They tell where to, not how much."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch
from matplotlib.patheffects import withStroke

from gripper.plot.style import SECOND
from gripper.result import Result
from gripper.results.nothing import least

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]

LONG = 0.12
"""Of the finger's length: a force's arrow; a moment's has a third of it as its radius."""
_BOW = 0.9
_BESIDE = 1e-6  # of a moment over the finger's length: a force this small is none
_NONE = 1e-12  # of the largest load of all poses: one this small is none


class Pull(NamedTuple):
    """A load on paper: the point (2,) where it acts, its unit direction (2,), 0 of a moment; the sign of a moment."""

    point: Array
    direction: Array
    turn: float


def pulls(result: Result, i: int, size: float) -> list[Pull]:
    """What is drawn of the loads of pose i, on a finger of this size (m).

    Nothing of those that are nothing, to the finger or beside the motion's largest: 10 sin(pi) N is round-off.
    """
    every = [max(math.hypot(*each.force), abs(each.moment) / size) for pose in result.poses for each in pose.loads]
    none = max(least(result.scene).force, _NONE * max(every, default=0.0))
    out = []
    for each in result.poses[i].loads:
        force, turn = np.array(each.force), each.moment / size
        strength = float(np.hypot(*force))
        if strength > max(none, _BESIDE * abs(turn)):
            out.append(Pull(np.array(each.point), force / strength, 0.0))
        elif abs(turn) > none:
            out.append(Pull(np.array(each.point), np.zeros(2), float(np.sign(turn))))
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
