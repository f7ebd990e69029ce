"""One pose on paper: what is drawn of it, and to what scale."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from gripper.objects import Object
from gripper.pose import placed
from gripper.result import Contact, PoseResult, Result, Shape

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""Left, bottom, right, top, in m."""

FORCE, SECOND, JAW, OBJECT, INK = "#D55E00", "#0072B2", "#56B4E9", "#E4E4E4", "#222222"
"""Colours that the colour-blind tell apart (Okabe & Ito 2008)."""
STRAIN = "viridis"
_LARGEST_ARROW = 0.4
"""Length of the largest force's arrow, as a part of the finger's: about, so that the scale is round."""
_MARGIN = 0.08
_SAMPLES = 200
_LARGE = 2.5
"""An object larger than this many fingers is drawn where the finger is, not whole."""


@dataclass(frozen=True)
class Sketch:
    """What one pose puts on paper: lengths in m, world frame.

    Parameters
    ----------
    pose, shape
        The answer.
    outline
        The object's polylines, (m, 2) each.
    whole
        Whether they are all of it; else it goes on beyond them.
    inside
        Points (k, k, 2) and g (k, k) where the object has no bounds or several outlines; else None.
    arrows
        Points (2,) and forces on the object (2,), in N.
    """

    pose: PoseResult
    shape: Shape
    outline: list[Array]
    whole: bool
    inside: tuple[Array, Array] | None
    arrows: list[tuple[Array, Array]]

    @property
    def wall(self) -> Array:
        """Corners (4, 2) of the wall behind the clamped section."""
        across = (self.shape.upper[0] - self.shape.lower[0]) * 0.75
        behind = np.array([-across[1], across[0]]) * 0.6  # `across` turned by +90 degrees: away from the tip
        ends = np.array([-across, across])
        return np.concatenate([self.shape.axis[0] + ends, self.shape.axis[0] + ends[::-1] + behind])

    @property
    def body(self) -> Array:
        """Every vertex of finger, jaw and wall, (n, 2)."""
        jaw = [] if self.shape.jaw is None else [self.shape.jaw]
        return np.concatenate([self.shape.outline, self.wall, *jaw])

    @property
    def size(self) -> float:
        """The finger's length on paper, in m."""
        return float(np.linalg.norm(np.diff(self.shape.axis, axis=0), axis=1).sum())


@dataclass(frozen=True)
class Key:
    """The scales that a figure's sketches share: units (name, factor), the largest force (N), m of arrow for a N."""

    length: tuple[str, float]
    force: tuple[str, float]
    largest: float
    arrow: float
    strain: Normalize

    @classmethod
    def of(cls, sketches: Sequence[Sketch]) -> Key:
        """Choose the scales that suit these sketches."""
        size = max(sketch.size for sketch in sketches)
        largest = max((math.hypot(*force) for sketch in sketches for _, force in sketch.arrows), default=0.0)
        strain = max(float(sketch.shape.strain.max()) for sketch in sketches)
        arrow = _round(_LARGEST_ARROW * size / largest) if largest else 0.0
        length = ("mm", 1e3) if size < 1 else ("m", 1.0)
        return cls(length, force_unit(largest), largest, arrow, Normalize(0.0, 100 * strain or 1.0))


def force_unit(largest: float) -> tuple[str, float]:
    """Choose the unit for forces up to this one (N): its name, and how many of it make a newton."""
    if largest >= 1e3:
        return "kN", 1e-3
    return ("N", 1.0) if largest >= 0.1 or largest == 0 else ("mN", 1e3)


def sketch(result: Result, i: int) -> Sketch:
    """Gather what pose i, which must not have failed, puts on paper."""
    answer = result.poses[i]
    assert answer.shape is not None, "a pose that failed has no shape"
    shape, target = answer.shape, placed(result.scene.object).body
    box = _surroundings(shape)
    own = target.outline(box)
    outline = [_moved(piece, *shape.object_pose) for piece in own]
    bounded = bool(np.isfinite(target.box).all())
    inside = None if bounded and len(own) == 1 else _inside(target, target.box if bounded else box, shape)
    return Sketch(answer, shape, outline, bounded, inside, _arrows(answer, shape))


def _moved(points: Array, x: float, y: float, angle: float) -> Array:
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return np.asarray(points @ turn.T + (x, y), dtype=float)


def _surroundings(shape: Shape) -> Box:
    """Give a box, in the object's own frame, that holds all of the world that may be drawn."""
    reach = 2 * float(np.ptp(shape.axis, axis=0).max())
    low, high = shape.axis.min(axis=0) - reach, shape.axis.max(axis=0) + reach
    x, y, angle = shape.object_pose
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    own = _moved(corners - (x, y), 0.0, 0.0, -angle)
    return (*own.min(axis=0).tolist(), *own.max(axis=0).tolist())


def _inside(target: Object, box: Box, shape: Shape) -> tuple[Array, Array]:
    """Sample g, for an object that its outline's polygon alone does not show: without bounds, or with a hole."""
    sides = np.meshgrid(np.linspace(box[0], box[2], _SAMPLES), np.linspace(box[1], box[3], _SAMPLES))
    own = np.stack(sides, axis=-1)
    return _moved(own, *shape.object_pose), target.gap(own.reshape(-1, 2)).reshape(_SAMPLES, _SAMPLES)


def _arrows(answer: PoseResult, shape: Shape) -> list[tuple[Array, Array]]:
    if len(answer.contacts) == 1 and answer.force_on_object is not None:
        return [(np.array(answer.contacts[0].point), np.array(answer.force_on_object))]
    return [(np.array(contact.point), _force(contact, shape)) for contact in answer.contacts]


def _force(contact: Contact, shape: Shape) -> Array:
    """Give the force on the object: against the outward normal, and friction along the face towards the tip."""
    steps = np.diff(shape.axis, axis=0)
    nearest = int(np.argmin(np.linalg.norm(shape.axis[1:] - contact.point, axis=1)))
    normal = np.array(contact.normal)
    tangent = np.array([-normal[1], normal[0]])
    towards_tip = tangent if tangent @ steps[nearest] > 0 else -tangent
    return np.asarray(contact.tangential_force * towards_tip - contact.normal_force * normal, dtype=float)


def extent(drawn: Sketch, key: Key) -> Box:
    """Give the box that holds finger, jaw, arrows and, unless it is far larger than the finger, the object."""
    heads = [point + key.arrow * force for point, force in drawn.arrows]
    points = [drawn.body, *(head[np.newaxis] for head in heads)]
    outline = np.concatenate(drawn.outline) if drawn.outline else drawn.body
    if drawn.whole and float(np.ptp(outline, axis=0).max()) < _LARGE * drawn.size:
        points.append(outline)
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    margin = _MARGIN * max(drawn.size, float((high - low).max()))
    return (*(low - margin), *(high + margin))


def draw(ax: Axes, drawn: Sketch, key: Key, level: int = 0) -> None:
    """Draw one pose into these axes, in the key's units; fingers of a higher level lie over those of a lower."""
    factor, above = key.length[1], 2.0 + level
    ink: dict[str, Any] = {"edgecolor": INK, "linewidth": 0.8}
    for piece in drawn.outline:
        filled = drawn.inside is None
        ax.add_patch(Polygon(factor * piece, closed=filled, fill=filled, facecolor=OBJECT, zorder=1.0, **ink))
    if drawn.inside is not None:
        points, g = drawn.inside
        lowest = min(float(g.min()), 0.0) - 1.0
        ax.contourf(*(factor * np.moveaxis(points, -1, 0)), g, levels=[lowest, 0.0], colors=[OBJECT], zorder=0.9)
    wall = factor * drawn.wall
    ax.add_patch(Polygon(wall, facecolor="white", edgecolor=INK, hatch="/////", linewidth=0.0, zorder=1.5))
    ax.plot(*wall[:2].T, color=INK, linewidth=1.5, zorder=above + 0.3)
    if drawn.shape.jaw is not None:
        ax.add_patch(Polygon(factor * drawn.shape.jaw, facecolor=JAW, zorder=above, **ink))
    _draw_strain(ax, drawn.shape, key, above + 0.1)
    ax.add_patch(Polygon(factor * drawn.shape.outline, fill=False, zorder=above + 0.2, **ink))
    for point, force in drawn.arrows:
        _draw_force(ax, factor * point, factor * key.arrow * force)


def _draw_strain(ax: Axes, shape: Shape, key: Key, above: float) -> None:
    """Fill the finger, section by section; without antialiasing, which would let hairs of background through."""
    lower, upper = key.length[1] * shape.lower, key.length[1] * shape.upper
    sections = np.stack([lower[:-1], lower[1:], upper[1:], upper[:-1]], axis=1)
    strain = 100 * (shape.strain[1:] + shape.strain[:-1]) / 2
    body = PolyCollection(list(sections), array=strain, cmap=STRAIN, norm=key.strain, antialiased=False, zorder=above)
    ax.add_collection(body, autolim=False)


def _draw_force(ax: Axes, tail: Array, arrow: Array) -> None:
    if arrow.any():
        scale: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "units": "inches", "width": 0.022}
        head: dict[str, Any] = {"headwidth": 4.5, "headlength": 5.5, "headaxislength": 5.0, "minlength": 0.1}
        halo = [withStroke(linewidth=1.6, foreground="white")]
        ax.quiver(*tail, *arrow, color=FORCE, zorder=1e3, path_effects=halo, **scale, **head)
    ax.plot(*tail, "o", color=INK, markersize=3.2, markeredgecolor="white", markeredgewidth=0.5, zorder=1e3)


def handles(key: Key) -> list[Artist]:
    """Give the entries of a legend: what the marks are, and the arrows' scale."""
    length_unit, lengths = key.length
    force_unit, forces = key.force
    newtons = _round(key.largest / 2)
    metres = newtons * key.arrow
    arrow = f"force on the object\n({newtons * forces:g} {force_unit} is {metres * lengths:.3g} {length_unit} long)"
    return [
        Line2D([], [], color=FORCE, marker=">", linewidth=1.6, markersize=5, label=arrow),
        Line2D([], [], color=INK, marker="o", linewidth=0, markersize=3.5, label="contact"),
    ]


def _round(value: float) -> float:
    """Round to 1, 2 or 5 times a power of ten."""
    decade = 10.0 ** math.floor(math.log10(value))
    return decade * min((1.0, 2.0, 5.0, 10.0), key=lambda digit: abs(digit - value / decade))
