"""Put a sketch into axes: the scales that a figure's sketches share, the marks, and what they mean."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from gripper.plot.load import draw_load
from gripper.plot.load import handle as load_handle
from gripper.plot.sketch import Array, Arrow, Box, Sketch
from gripper.plot.style import FORCE, INK, JAW, OBJECT, STRAIN
from gripper.plot.units import Unit, force_unit, labelled, length_unit, strain_unit
from gripper.result import Shape
from gripper.results.nothing import PART

_LARGEST_ARROW = (0.4, 0.15)
"""Length of the largest force's arrow, as a part of the finger's: about, so that the scale is round. Arrows of two
fingers come from both sides of the object, and shorter ones keep apart."""
_ROUND, _SCALES = (1.0, 2.0, 5.0, 10.0), (1.0, 1.5, 2.0, 3.0, 5.0, 10.0)
"""What a figure's numbers are rounded to, and its arrows' scale, but for powers of ten."""
_SHADES = 3
"""Shades between two stations of a shape."""
_INK: dict[str, Any] = {"edgecolor": INK, "linewidth": 0.8}


@dataclass(frozen=True)
class Key:
    """The scales that a figure's sketches share: units, the largest force (N), m of arrow for a N, and the marks."""

    length: Unit
    force: Unit
    largest: float
    arrow: float
    strain: Unit
    shades: Normalize
    jaw: bool
    sticks: bool
    loads: bool

    @classmethod
    def of(cls, panels: Sequence[Sequence[Sketch]]) -> Key:
        """Choose the scales that suit these panels, of one finger each or of two."""
        sketches = [each for panel in panels for each in panel]
        part = _LARGEST_ARROW[len(panels[0]) > 1]
        size = max(each.size for each in sketches)
        arrows = [arrow for each in sketches for arrow in each.arrows]
        largest = max((math.hypot(*arrow.force) for arrow in arrows), default=0.0)
        strain = max(float(each.shape.strain.max()) for each in sketches)
        strain = strain if strain > PART else 0.0
        return cls(
            length=length_unit(size),
            force=force_unit(largest),
            largest=largest,
            arrow=_round(part * size / largest, _SCALES) if largest else 0.0,
            strain=strain_unit(strain),
            shades=Normalize(0.0, strain_unit(strain).factor * strain or 1.0),
            jaw=any(each.shape.jaw is not None for each in sketches),
            sticks=any(arrow.sticks for arrow in arrows),
            loads=any(each.pulls for each in sketches),
        )

    def handles(self) -> list[Artist]:
        """Give the entries of a legend: what the marks are, and the arrows' scale."""
        entries: list[Artist] = []
        if self.arrow:
            newtons = _round(self.largest / 2)
            long = f"{newtons * self.arrow * self.length.factor:.3g} {self.length.name}"
            name = f"force on the object ({newtons * self.force.factor:g} {self.force.name}: {long})"
            entries += [
                Line2D([], [], color=FORCE, marker=">", linewidth=1.6, markersize=5, label=name),
                _mark("slips" if self.sticks else "contact", sticks=False),
            ]
        if self.sticks:
            entries.append(_mark("sticks", sticks=True))
        if self.loads:
            entries.append(load_handle())
        if self.jaw:
            entries.append(Patch(facecolor=JAW, edgecolor=INK, linewidth=0.6, label="rigid jaw"))
        return entries

    def colours(self) -> ScalarMappable:
        """Give the colours of strain, for a bar."""
        return ScalarMappable(self.shades, STRAIN)


def draw(ax: Axes, drawn: Sketch, key: Key, level: int = 0) -> list[Artist]:
    """Draw one finger into these axes, in the key's units; those of a higher level lie over those of a lower."""
    factor, above = key.length.factor, 2.0 + level
    done: list[Artist] = _draw_object(ax, drawn, factor)
    wall = factor * drawn.wall
    done.append(ax.add_patch(Polygon(wall, facecolor="white", edgecolor=INK, hatch="//////", linewidth=0, zorder=1.5)))
    done += ax.plot(*wall[:2].T, color=INK, linewidth=1.5, zorder=above + 0.3)
    if drawn.shape.jaw is not None:
        done.append(ax.add_patch(Polygon(factor * drawn.shape.jaw, facecolor=JAW, zorder=above, **_INK)))
    done.append(_draw_strain(ax, drawn.shape, key, above + 0.1))
    done.append(ax.add_patch(Polygon(factor * drawn.shape.outline, fill=False, zorder=above + 0.2, **_INK)))
    for arrow in drawn.arrows:
        done += _draw_force(ax, arrow, key)
    done += [draw_load(ax, pull, drawn.size, factor) for pull in drawn.pulls]
    return done


def _draw_object(ax: Axes, drawn: Sketch, factor: float) -> list[Artist]:
    filled = drawn.inside is None
    done: list[Artist] = [
        ax.add_patch(Polygon(factor * piece, closed=filled, fill=filled, facecolor=OBJECT, zorder=1.0, **_INK))
        for piece in drawn.outline
    ]
    if drawn.inside is not None:
        points, g = drawn.inside
        lowest = min(float(g.min()), 0.0) - 1.0
        across = factor * np.moveaxis(points, -1, 0)
        done.append(ax.contourf(*across, g, levels=[lowest, 0.0], colors=[OBJECT], zorder=0.9))
    return done


def _draw_strain(ax: Axes, shape: Shape, key: Key, above: float) -> Artist:
    """Fill the finger, section by section; without antialiasing, which would let hairs of background through."""
    lower, upper = key.length.factor * shape.lower, key.length.factor * shape.upper
    fine = np.linspace(0, len(lower) - 1, _SHADES * (len(lower) - 1) + 1)
    stations = np.arange(len(lower))
    lower, upper = (np.stack([np.interp(fine, stations, x) for x in face.T], axis=1) for face in (lower, upper))
    sections = np.stack([lower[:-1], lower[1:], upper[1:], upper[:-1]], axis=1)
    strain = key.strain.factor * np.interp((fine[1:] + fine[:-1]) / 2, stations, shape.strain)
    body = PolyCollection(list(sections), array=strain, cmap=STRAIN, norm=key.shades, antialiased=False, zorder=above)
    ax.add_collection(body, autolim=False)
    return body


def _draw_force(ax: Axes, arrow: Arrow, key: Key) -> list[Artist]:
    tail: Array = key.length.factor * arrow.point
    length: Array = key.length.factor * key.arrow * arrow.force
    done: list[Artist] = []
    if length.any():
        scale: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "units": "inches", "width": 0.017}
        head: dict[str, Any] = {"headwidth": 4.5, "headlength": 5.0, "headaxislength": 4.5, "minlength": 0.1}
        halo = [withStroke(linewidth=1.6, foreground="white")]
        done.append(ax.quiver(*tail, *length, color=FORCE, zorder=1e3, path_effects=halo, **scale, **head))
    mark = _mark("", arrow.sticks)
    mark.set_data(tail[:1], tail[1:])
    mark.set_zorder(1e3)
    return [*done, ax.add_line(mark)]


def _mark(name: str, sticks: bool) -> Line2D:
    look: dict[str, Any] = {"color": INK, "markeredgecolor": "white", "markeredgewidth": 0.5, "linewidth": 0}
    return Line2D([], [], marker="s" if sticks else "o", markersize=4.2 if sticks else 3.6, label=name, **look)


def frame(ax: Axes, window: Box, key: Key, *, ticks: int = 5) -> None:
    """Set equal axes with this window (m), in the key's unit."""
    left, bottom, right, top = (key.length.factor * side for side in window)
    ax.set_xlim(left, right)
    ax.set_ylim(bottom, top)
    ax.set_aspect("equal")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 5, 10]))
    ax.set_xlabel(labelled("x", key.length))
    ax.set_ylabel(labelled("y", key.length))


def _round(value: float, digits: tuple[float, ...] = _ROUND) -> float:
    """Round to one of these digits times a power of ten."""
    decade = 10.0 ** math.floor(math.log10(value))
    return decade * min(digits, key=lambda digit: abs(digit - value / decade))
