"""Where finger and object touch: a contact's kind, place and unknowns.

A contact's place is an unknown of its own and moves between nodes. Its kinds:

``tangent``  a smooth stretch of the object on a face or an edge: g = 0 and dg/du = 0 at u;
``corner``   a corner of the outline on the object: g = 0;
``node``     a fixed place of a face or an edge: g = 0 (where both conform, and no place is singled out);
``vertex``   a corner of the object on a face or an edge: signed distance 0 at the foot of the normal;
``patch``    with shear, a smooth object is touched over [a, b], because gamma drops to zero behind a force: the
             pressure is a polynomial, the gap's moments against it vanish, and so does the gap at both ends;
``tail``     a patch whose far end is known: the tip, where the tip's corner carries the rest, or, where the finger lies
             flush on a flat, the object's corner that the flat ends in (and that carries the rest), or a place so far
             that the pressure has decayed;
``span``     the same over the whole of an object's side, both of whose corners carry.

How an end at a corner moves changes nothing to first order: what the pressure loses there the corner's force gains.

Where gamma jumps at a concentrated force, "the" tangent of the face is the mean of both sides: this is what makes
the energy stationary in the place of the force (configurational balance).
"""

from __future__ import annotations

import bisect
import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from gripper.arrays import Array
from gripper.beam.legendre import legendre
from gripper.beam.strains import Beam
from gripper.contact.outline import UPPER

if TYPE_CHECKING:
    from gripper.contact.grip import Grip

Kind = Literal["tangent", "corner", "node", "vertex", "patch", "tail", "span"]
NARROW, WIDE, WIDEST = 2, 8, 14
"""Pressure modes of a patch: short, or long, against the length over which shear decays, or followed to nothing."""
_UNKNOWN_PLACES = {"tangent": 1, "corner": 0, "node": 0, "vertex": 1, "patch": 2, "tail": 1, "span": 0}
CUTS = {6: (0.35,), 8: (0.12, 0.35), 12: (0.07, 0.2, 0.45)}
# parts of a patch with many modes where its segments end: strains of order p carry pressures of order p - 1, and the
# pressure decays from the near end


@dataclass(frozen=True)
class Site:
    """One contact: its kind, the piece of the outline, its place there, and the corner or vertex it belongs to."""

    kind: Kind
    piece: int
    place: tuple[float, ...]
    vertex: int = -1
    modes: int = 1  # of its pressure
    grip: Grip | None = None
    """How it holds; None without friction."""

    @property
    def multipliers(self) -> int:
        """How many multipliers the contact has."""
        return self.modes

    @property
    def unknown_places(self) -> int:
        """How many coordinates of its place are unknown."""
        return _UNKNOWN_PLACES[self.kind]

    @property
    def unknowns(self) -> int:
        """Unknown coordinates of its place, and the ratio of its friction where that is unknown: the last one."""
        return self.unknown_places + (self.grip is not None and self.grip.unknown)

    @property
    def lifts_off(self) -> bool:
        """Whether its place is where the slope of the face before it vanishes, not the gap (which does all along)."""
        return self.kind == "tail" and self.modes > NARROW

    @property
    def spreads(self) -> bool:
        """Whether it carries a pressure along a stretch."""
        return self.kind in ("patch", "tail", "span")

    @property
    def on_face(self) -> bool:
        """Whether it lies on a flexible face."""
        return self.piece <= UPPER

    @property
    def flush(self) -> bool:
        """Whether friction, which would bend the face before it away from a flat by its lever, acts at the axis."""
        if self.grip is None or not self.grip.flush:
            return False
        return self.bends_away(self.grip.ratios(self.piece, self.middle)[0])

    def bends_away(self, ratio: float) -> bool:
        """Whether friction of this ratio bends the face before it away from the object, by its lever to the axis."""
        return ratio < 0 if self.piece < UPPER else ratio > 0

    @property
    def middle(self) -> float:
        """Its place, or the middle of its patch (0 of a corner)."""
        return (self.place[0] + self.place[-1]) / 2 if self.place else 0.0

    @property
    def coordinates(self) -> tuple[float, ...]:
        """Values of its unknowns."""
        places = self.place[: _UNKNOWN_PLACES[self.kind]]
        return places if self.grip is None or not self.grip.unknown else (*places, self.grip.ratio)

    def moved(self, coordinates: Array) -> Site:
        """The same contact at other values of its unknowns."""
        values, count, grip = coordinates.tolist(), _UNKNOWN_PLACES[self.kind], self.grip
        if grip is not None and grip.unknown:
            grip = replace(grip, ratio=values[-1])
        place = (*values[:count], *self.place[count:]) if count else self.place
        return Site(self.kind, self.piece, place, self.vertex, self.modes, grip)

    def breaks(self) -> tuple[float, ...]:
        """Where the strains have kinks because of it."""
        if not self.on_face or self.modes not in CUTS:
            return self.place if self.on_face else ()
        a, b = self.place
        return (a, *(a + cut * (b - a) for cut in CUTS[self.modes]), b)


@functools.cache
def pressure_rule(modes: int, order: int) -> tuple[Array, Array]:
    """Gauss points (q,) of a patch on [-1, 1], and the pressure modes' mean values over it (modes, q).

    More points than the strains have modes, on each of its segments: these would resolve the single points else.
    """
    ends = 2 * np.array([0.0, *CUTS.get(modes, ()), 1.0]) - 1
    x, weights = np.polynomial.legendre.leggauss(max(modes + 4 if modes not in CUTS else 0, order + 3))
    halves = np.diff(ends)[:, None] / 2
    x, weights = (ends[:-1, None] + halves * (x + 1)).ravel(), (halves * weights).ravel()
    return x, legendre(x, modes).T * weights / 2


def tied(sites: tuple[Site, ...]) -> tuple[Site, ...]:
    """The same with the pressures that end at the object's corners ending there: the feet of their normals move."""
    found = list(sites)
    for i, site in enumerate(sites):
        near, far = corners_of(sites, i)
        if far is not None:
            start = site.place[0] if near is None else sites[near].place[0]
            found[i] = replace(site, place=(start, sites[far].place[0]))
    return tuple(found)


def corners_of(sites: Sequence[Site], i: int) -> tuple[int | None, int | None]:
    """Which sites are the object's corners that a pressure begins at and ends at; None where it has none there."""
    site = sites[i]
    if site.kind not in ("tail", "span") or site.vertex < 0:
        return None, None
    mine = [j for j, other in enumerate(sites) if (other.kind, other.piece) == ("vertex", site.piece)]
    far = next((j for j in mine if sites[j].vertex == site.vertex), None)
    others = [j for j in mine if j != far and site.kind == "span"]
    return min(others, key=lambda j: abs(sites[j].place[0] - site.place[0]), default=None), far


def pointed(site: Site) -> Site:
    """A patch as a point in its middle, without friction."""
    if site.spreads:
        return replace(site, kind="tangent", place=(site.middle,), modes=1, grip=None)
    return replace(site, grip=None)


def own_segment(beam: Beam, site: Site) -> int:
    """The segment that a contact lies on; beyond the faces the last one."""
    if not site.on_face:
        return beam.segments - 1
    return min(max(bisect.bisect_right(beam.breaks, site.middle) - 1, 0), beam.segments - 1)
