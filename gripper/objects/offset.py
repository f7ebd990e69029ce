"""An object grown by a distance: every point of it becomes a disc."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gripper.fields import Length
from gripper.objects.base import Array, Box, Object, chord_tolerance
from gripper.objects.compiled import PerInstance
from gripper.objects.contour import refined, settled
from gripper.objects.distance import Distance
from gripper.objects.faces import rings, room
from gripper.objects.part import Member, Part
from gripper.objects.traced import chain_of
from gripper.pose import placed

TRACE = 1e-6  # of the size: the polyline that the outline is traced by
QUARTER = 400  # chords of a quarter turn about a corner of the part
REACH = 1e-5  # of the size: vertices are that near to the outline
BENT = 0.02  # rad: where the traced polyline turns inwards by more the outline has a re-entrant corner
CLOSER = (1e-3, 1e-5, 1e-7)  # of the size: as far on either side a re-entrant corner's tangents are read


@dataclass(frozen=True, kw_only=True)
class Offset(Object):
    """An object grown by a distance d: g is the signed distance to its outline, less d.

    Convex corners become arcs of radius d; re-entrant ones stay; gaps narrower than 2 d close.

    Parameters
    ----------
    part
        The object, with bounds, as it is or placed by numbers.
    distance
        D, in m.

    Raises
    ------
    ValueError
        The part has no bounds, or corners that it does not name.
    """

    part: Part
    distance: Length

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "part", placed(self.part))
        grown_of(self)

    def evaluate(self, points: Array, order: int = 2) -> tuple[Array, ...]:
        """See `Object.evaluate`."""
        g, *rest = grown_of(self).base.evaluate(points, order)
        return (g - self.distance, *rest)

    def bounds(self, centers: Array, radii: Array) -> tuple[Array, Array]:
        """See `Object.bounds`: a distance's slope is 1."""
        return np.ones(len(centers)), grown_of(self).base.least_curvature(centers, radii)

    def largest_curvature(self, centers: Array, radii: Array) -> Array:
        """See `Object.largest_curvature`."""
        return grown_of(self).base.largest_curvature(centers, radii)

    @property
    def hollows(self) -> Array:
        """See `Object.hollows`: where two stretches of the part's outline are equally near."""
        return grown_of(self).hollows[0]

    @property
    def hollow_normals(self) -> Array:
        """See `Object.hollow_normals`."""
        return grown_of(self).hollows[1]

    @property
    def box(self) -> Box:
        """See `Object.box`."""
        xmin, ymin, xmax, ymax = grown_of(self).base.chain.box
        d = self.distance
        return (xmin - d, ymin - d, xmax + d, ymax + d)

    @property
    def inner_radius(self) -> float:
        """See `Object.inner_radius`."""
        return grown_of(self).room[1]

    @property
    def inner_point(self) -> Array:
        """See `Object.inner_point`."""
        return grown_of(self).room[0]

    def outline(self, box: Box | None = None, tolerance: float | None = None) -> list[Array]:
        """See `Object.outline`."""
        grown = grown_of(self)
        fine = chord_tolerance(tolerance, grown.size)
        lines = [settled(self.evaluate, line, self.hollows, REACH * grown.size) for line in rings(grown.polygons)]
        return [refined(self.evaluate, line, fine) for line in lines]


class Grown:
    """What is found of one grown object."""

    def __init__(self, owner: Offset) -> None:
        self.base = Distance(chain_of(Member(owner.part), "part"))
        self.distance = owner.distance
        self.size = self.base.chain.size + 2 * owner.distance

    @cached_property
    def polygons(self) -> list[Any]:
        """Shapely polygons within 1e-5 of the size of what is inside."""
        import shapely

        lines = self.base.chain.polylines(TRACE * self.size)
        holes = [line for line in lines if not shapely.LinearRing(line).is_ccw]
        whole = shapely.unary_union([shapely.Polygon(line) for line in lines if shapely.LinearRing(line).is_ccw])
        whole = shapely.difference(whole, shapely.unary_union([shapely.Polygon(line) for line in holes]))
        return list(shapely.get_parts(whole.buffer(self.distance, quad_segs=QUARTER)))

    @cached_property
    def room(self) -> tuple[Array, float]:
        """A point well inside, and the radius of the largest disc inside the smallest part, in m."""
        return room(self.polygons, self.size)

    def _level(self, points: Array, order: int) -> tuple[Array, ...]:
        g, *rest = self.base.evaluate(points, order)
        return (g - self.distance, *rest)

    @cached_property
    def hollows(self) -> tuple[Array, Array]:
        """Re-entrant corners (k, 2), in m, and the normals (k, 2, 2) before and after each."""
        found = [vertex for ring in rings(self.polygons) for vertex in ring[:-1][_turns(ring) < -BENT]]
        corners = [_closed_in(self._level, point, self.size) for point in found]
        points = np.array([point for point, _ in corners]).reshape(-1, 2)
        return points, np.array([normals for _, normals in corners]).reshape(-1, 2, 2)


def _turns(ring: Array) -> Array:
    """By how much a closed polyline (m + 1, 2) turns to the left at its vertices (m,), in rad."""
    after = np.diff(ring, axis=0)
    before = np.roll(after, 1, axis=0)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(np.arctan2(cross, (before * after).sum(axis=1)))


def _closed_in(level: Callable[[Array, int], tuple[Array, ...]], point: Array, size: float) -> tuple[Array, Array]:
    """The corner near a point (2,) of the outline, and its normals (2, 2): where the tangents beside it cross."""
    normals = np.zeros((2, 2))
    for closer in CLOSER:
        outward = level(point[None], 1)[1][0] if closer == CLOSER[0] else normals.sum(axis=0)
        outward = outward / np.linalg.norm(outward)
        along = np.array([-outward[1], outward[0]])
        beside = point + closer * size * np.array([-along, along])
        g, normals = level(beside, 1)
        point = np.linalg.solve(normals, (normals * beside).sum(axis=1) - g)
    return point, normals


grown_of: PerInstance[Offset, Grown] = PerInstance(Grown)
