"""Set operations: one object of several parts, its g the least or the largest of theirs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from gripper.objects.base import Array, Box, Object, chord_tolerance
from gripper.objects.compiled import PerInstance
from gripper.objects.contour import refined, settled
from gripper.objects.faces import enclosed, rings, room
from gripper.objects.part import Member, Part
from gripper.objects.seams import NEAR, Corners, corners, crossings
from gripper.pose import placed

TRACE = 2e-6  # of the whole's size: the polylines that crossings are looked for on
MARGIN = 0.25  # of the parts' span: as far beyond them the region is traced
FAR = 10.0  # the same, where a part has no bounds: as far beyond the other parts crossings are looked for
SNAP = 4.0  # times the trace: a vertex that near to a corner is the corner


@dataclass(frozen=True, kw_only=True)
class Combined(Object):
    """An object of parts: a plugin says with which signs, and whether the least or the largest g counts.

    g keeps the parts' slopes. At convex corners where parts cross it falls short of the distance; the corners
    themselves are known exactly. |grad g| and the Hessian are proved where they are of the parts that may count.

    Parameters
    ----------
    parts
        Objects, as they are or placed by numbers: ``Circle(radius=0.01).at(x=0.02)``.

    Raises
    ------
    ValueError
        Nothing is left inside, or what is left has no outline.
    """

    parts: tuple[Part, ...]
    largest: ClassVar[bool]
    """Whether the largest of the parts' g is the whole's (what all of them enclose), or the least."""

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "parts", tuple(placed(part) for part in self.parts))
        if len(self.parts) < 2:
            raise ValueError(f"parts must hold at least 2 objects; got {len(self.parts)}")
        whole_of(self).check()

    @property
    def signs(self) -> tuple[float, ...]:
        """A sign a part: -1 for what is cut out."""
        return (1.0,) * len(self.parts)

    def evaluate(self, points: Array, order: int = 2) -> tuple[Array, ...]:
        """See `Object.evaluate`: of the part that counts."""
        return whole_of(self).evaluate(points, order)

    @property
    def corners(self) -> Array:
        """See `Object.corners`: the parts' that are left, and where they cross."""
        return whole_of(self).corners[0].points

    @property
    def corner_normals(self) -> Array:
        """See `Object.corner_normals`."""
        return whole_of(self).corners[0].normals

    @property
    def hollows(self) -> Array:
        """See `Object.hollows`."""
        return whole_of(self).corners[1].points

    @property
    def hollow_normals(self) -> Array:
        """See `Object.hollow_normals`."""
        return whole_of(self).corners[1].normals

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """See `Object.bounds`: of the parts that can count over a disc."""
        return whole_of(self).bounds(centers, radii)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """See `Object.largest_curvature`."""
        return whole_of(self).largest_curvature(centers, radii)

    @property
    def box(self) -> Box:
        """See `Object.box`."""
        return whole_of(self).box

    @property
    def inner_radius(self) -> float:
        """See `Object.inner_radius`."""
        return whole_of(self).room[1]

    @property
    def inner_point(self) -> Array:
        """See `Object.inner_point`."""
        return whole_of(self).room[0]

    def outline(self, box: Box | None = None, tolerance: float | None = None) -> list[Array]:
        """See `Object.outline`."""
        return whole_of(self).outline(box, tolerance)


class Whole:
    """What is found from the parts of one combined object."""

    def __init__(self, owner: Combined) -> None:
        self.members = [Member(part, sign) for part, sign in zip(owner.parts, owner.signs, strict=True)]
        self.largest = owner.largest

    def evaluate(self, points: Array, order: int) -> tuple[Array, ...]:
        """Return g and its derivatives, as `Object.evaluate`."""
        values = [member.evaluate(points, order) for member in self.members]
        which, every = self.counting(np.stack([value[0] for value in values])), np.arange(len(points))
        return tuple(np.stack(derivative)[which, every] for derivative in zip(*values, strict=True))

    def counting(self, g: Array) -> Any:
        """Which of the parts counts at each point, (n,), of all their g (parts, n)."""
        return g.argmax(axis=0) if self.largest else g.argmin(axis=0)

    def gap(self, points: Array) -> Array:
        """G (n,), in m."""
        return self.evaluate(points, 0)[0]

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array] | None:
        """As `Object.bounds`."""
        bounds = [member.bounds(centers, radii) for member in self.members]
        known = [bound for bound in bounds if bound is not None]
        if len(known) < len(bounds):
            return None
        steepest, least = (np.stack(values) for values in zip(*known, strict=True))
        counts = self._counting(centers, radii, steepest)
        steep = np.where(counts, steepest, 0.0).max(axis=0)
        lowest = np.where(counts, least, np.inf).min(axis=0)
        hidden = (not self.largest) & (counts.sum(axis=0) > 1)  # where the least changes over, its kink is concave
        return steep, np.where(hidden, -np.inf, lowest)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """As `Object.largest_curvature`."""
        bounds = [member.bounds(centers, radii) for member in self.members]
        steepest = np.stack([np.full(len(centers), np.inf) if bound is None else bound[0] for bound in bounds])
        counts = self._counting(centers, radii, steepest)
        highest = np.stack([member.largest_curvature(centers, radii) for member in self.members])
        hidden = self.largest & (counts.sum(axis=0) > 1)
        return np.where(hidden, np.inf, np.where(counts, highest, -np.inf).max(axis=0))

    def _counting(self, centers: Array, radii: Array, steepest: Array) -> Array:
        """Which parts (k, n) can give g somewhere in each disc."""
        g = np.stack([member.evaluate(centers, 0)[0] for member in self.members])
        reach = np.nan_to_num(steepest * radii, nan=np.inf) + 1e-14 * np.abs(g)
        if self.largest:
            return np.asarray(g + reach >= (g - reach).max(axis=0))
        return np.asarray(g - reach <= (g + reach).min(axis=0))

    @cached_property
    def window(self) -> Box:
        """Where the parts are, with a margin, in m."""
        anchors = np.concatenate([member.anchors for member in self.members])
        low, high = anchors.min(axis=0), anchors.max(axis=0)
        bounded = all(np.isfinite(member.body.box).all() for member in self.members)
        span = float((high - low).max()) or float(np.abs(anchors).max()) or 1.0
        margin = span * (MARGIN if bounded else FAR)
        return (float(low[0] - margin), float(low[1] - margin), float(high[0] + margin), float(high[1] + margin))

    @cached_property
    def size(self) -> float:
        """Of the window, in m."""
        return max(self.window[2] - self.window[0], self.window[3] - self.window[1])

    @cached_property
    def corners(self) -> tuple[Corners, Corners]:
        """Convex and re-entrant corners, in their order along the outline."""
        lines = [member.lines(self.window, TRACE * self.size) for member in self.members]
        own = [member.corners[0] for member in self.members]
        candidates = np.concatenate([*own, crossings(lines, self.members, self.size)])
        found = corners(candidates, self.members, self.gap, self.size)
        drawn, reach = rings(self.polygons), SNAP * TRACE * self.size
        return _ordered(found[0], drawn, reach), _ordered(found[1], drawn, reach)

    def _traced(self, window: Box, tolerance: float) -> list[Any]:
        lines = [line for member in self.members for line in member.lines(window, tolerance)]
        return enclosed(lines, window, self.gap)

    @cached_property
    def polygons(self) -> list[Any]:
        """What is inside, within the window, as shapely polygons."""
        return self._traced(self.window, TRACE * self.size)

    @cached_property
    def bounded(self) -> bool:
        """Whether the outline stays within the window."""
        low, high = np.reshape(self.window, (2, 2))
        vertices = np.concatenate(rings(self.polygons))
        return bool((vertices > low).all() and (vertices < high).all())

    def check(self) -> None:
        """Refuse parts of which nothing is left, or that leave no outline."""
        if not self.polygons:
            raise ValueError(f"parts must leave something inside; got nothing, within {self.window}, in m")
        if len(self.polygons) == 1 and not len(self.outline(self.window, TRACE * self.size)):
            raise ValueError(f"parts must leave an outline; got none, within {self.window}, in m")

    @cached_property
    def box(self) -> Box:
        """As `Object.box`."""
        if not self.bounded:
            return (-math.inf, -math.inf, math.inf, math.inf)
        vertices, slack = np.concatenate(rings(self.polygons)), 2 * TRACE * self.size
        low, high = vertices.min(axis=0) - slack, vertices.max(axis=0) + slack
        return float(low[0]), float(low[1]), float(high[0]), float(high[1])

    @cached_property
    def room(self) -> tuple[Array, float]:
        """A point well inside, and the radius of the largest disc inside the smallest part, in m (or inf)."""
        point, radius = room(self.polygons, self.size)
        if self.gap(point[None])[0] >= 0:  # on the seam of two parts
            point = point + 1e-3 * radius
        if self.bounded:
            return point, radius
        low, high = np.reshape(self.window, (2, 2))
        islands = [
            p for p in self.polygons if (np.reshape(p.bounds, (2, 2)) > low).all() and (p.bounds[2:] < high).all()
        ]
        return point, room(islands, self.size)[1] if islands else math.inf

    def outline(self, box: Box | None, tolerance: float | None) -> list[Array]:
        """As `Object.outline`."""
        if not self.bounded and box is None:
            raise ValueError("box must be given, finite and in m, for an outline without bounds; got None")
        window = self.window if self.bounded or box is None else box
        size = max(window[2] - window[0], window[3] - window[1])
        fine = chord_tolerance(tolerance, size)
        traced = rings(self.polygons if self.bounded else self._traced(window, TRACE * size))
        lines = [piece for ring in traced for piece in _open(ring, window)]
        known = np.concatenate([found.points for found in self.corners])
        return [
            refined(self.evaluate, settled(self.evaluate, line, known, SNAP * TRACE * size), fine) for line in lines
        ]


def _ordered(found: Corners, lines: list[Array], reach: float) -> Corners:
    """The corners as they follow one another along polylines that pass them within reach (m); others are none."""
    vertices = np.concatenate(lines)
    distance = np.linalg.norm(found.points[:, None] - vertices, axis=2)
    near = np.flatnonzero(distance.min(axis=1) < reach)
    order = near[np.argsort(distance[near].argmin(axis=1))]
    return Corners(found.points[order], found.normals[order])


def _open(ring: Array, window: Box) -> list[Array]:
    """A closed ring (m, 2) without its edges along the window's frame: what is left, in pieces."""
    low, high = np.reshape(window, (2, 2))
    near = NEAR * float((high - low).max())
    on = np.concatenate([np.abs(ring - low) < near, np.abs(ring - high) < near], axis=1)
    framed = (on[1:] & on[:-1]).any(axis=1)
    if not framed.any():
        return [ring]
    first = int(np.flatnonzero(framed)[0])
    edges = np.roll(np.arange(len(framed)), -first)
    runs = np.split(edges, np.flatnonzero(np.diff(framed[edges].astype(int))) + 1)
    return [ring[np.append(run, run[-1] + 1) % (len(ring) - 1)] for run in runs if not framed[run[0]]]


whole_of: PerInstance[Combined, Whole] = PerInstance(Whole)
