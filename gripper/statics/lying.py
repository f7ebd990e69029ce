"""With friction a face comes to lie on a flat of the object, and leaves it: which contacts carry is found from before.

Friction bends the face by its lever to the axis. Where it bends it away from the flat, normal force and friction go
together to where they have no moment about the axis (:class:`gripper.contact.grip.Grip`, ``flush``). On its way there
from the flat's first corner the force is on the corner and beside it; at the flat's end it is on the last corner as
soon as it acts there.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER, dot, outward
from gripper.contact.site import Site
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.newton import settle
from gripper.statics.rolling import instead

BESIDE = 1e-3
"""Of L: how far beside its first corner a flat carries what the corner does not."""
_TURNS = 6
_HAIR = 1e-10  # of L
_IN_LINE = 5e-2  # of L and of their distance: how far a flat's corners may be off a face that is to lie on it
_SAME = 1e-9  # of L


@dataclass(frozen=True)
class _Flat:
    """A side of the object along a face: its corners, and where they are along the face from the contact on."""

    corners: tuple[int, int]
    ends: tuple[float, float]


def laid_ahead(setting: Setting, obstacle: Obstacle, state: State) -> State:
    """A guess with the contacts that the face goes over to, where it leaves a flat."""
    following = _next(setting, obstacle, state)
    leaves = following is not None and any(site.kind in ("tangent", "node") for site in state.sites)
    return following if following is not None and leaves else state


def laid(setting: Setting, equilibrium: Equilibrium, order: int, *, judged: bool = False) -> Equilibrium:
    """The equilibrium whose last contact lies on a flat where the face does.

    Raises
    ------
    NoEquilibriumError
        Where Newton does not converge with one of the sets of contacts, or these go over to one another without end.
    """
    start = equilibrium
    tried: list[list[tuple[str, int, int]]] = []
    while (following := _next(setting, equilibrium.obstacle, equilibrium.state)) is not None:
        here = _touching(equilibrium.state)
        at_corner = all(site.kind != "tangent" for site in equilibrium.state.sites)
        if at_corner and here in tried:  # neither is quite right, by less than what a corner's penetration tells
            return start if here == tried[0] else equilibrium
        tried.append(here)
        try:
            found = settle(setting, equilibrium.obstacle, following, order, judged=judged)
        except NoEquilibriumError:
            if not at_corner:
                raise
            break  # its penetration tells
        way, rounds = equilibrium.correction + found.correction, equilibrium.iterations + found.iterations
        equilibrium = replace(found, correction=way, iterations=rounds)
        if len(tried) > _TURNS:
            raise NoEquilibriumError("a face lies down and gets up without end")
    return equilibrium


def _touching(state: State) -> list[tuple[str, int, int]]:
    return [(site.kind, site.piece, site.vertex) for site in state.sites]


def _next(setting: Setting, obstacle: Obstacle, state: State) -> State | None:
    """The state with other contacts at its end; None where they may stay."""
    if setting.theory != "bending" or not state.sites or state.sites[0].grip is None:
        return None
    last = max(range(len(state.sites)), key=lambda i: (state.sites[i].piece > UPPER, state.sites[i].middle))
    site = state.sites[last]
    if site.kind != "node" and float(state.loads[last][0]) <= 0:
        return None  # it lets go
    if site.kind == "corner":
        return _off_tip(setting, obstacle, state, last)
    if not site.on_face:
        return None
    if site.kind == "tangent":
        return _off(setting, obstacle, state, last)
    if site.kind == "vertex":
        return _down(setting, obstacle, state, last)
    corner = next((i for i, s in enumerate(state.sites) if _begins(s, site)), None)
    return None if corner is None else _along(state, corner, last)


def _begins(corner: Site, site: Site) -> bool:
    """Whether a site beside the corner at which a flat begins carries with it."""
    near = site.kind == "node" and corner.kind == "vertex" and corner.piece == site.piece
    return near and 0 < site.middle - corner.middle < 2 * BESIDE


def _along(state: State, corner: int, beside: int) -> State | None:
    """From the flat's first corner and the place beside it to the one of both that presses."""
    loads = state.loads
    if loads[beside][0] < 0:
        return _instead(state, (corner, beside), [(state.sites[corner], float(loads[corner][0]))])
    if loads[corner][0] < 0:
        site = replace(state.sites[beside], kind="tangent")
        return _instead(state, (corner, beside), [(site, float(loads[beside][0]))])
    return None


def beside(state: State, corner: int) -> State:
    """The state that may also carry beside a corner of the object, on the flat that begins there: its last contact."""
    site, load = state.sites[corner], float(state.loads[corner][0])
    second = replace(site, kind="node", place=(site.place[0] + BESIDE,), vertex=-1)
    return _instead(state, (corner,), [(site, load), (second, 0.0)])


def _off(setting: Setting, obstacle: Obstacle, state: State, i: int) -> State | None:
    """From a flat to one of the corners that it ends in, or to the tip's corner."""
    site, load = state.sites[i], float(state.loads[i][0])
    place = min(max(site.place[0], 0.0), 1.0)
    flat = _flat(setting, obstacle, state, replace(site, place=(place,)))
    if flat is None:
        return None
    ahead, tip = reach(setting, site), setting.outline.tip_corner(site.piece)
    if min(flat.ends[1], 1 - place) <= ahead:
        if tip is not None and 1 - place < flat.ends[1]:
            corner = replace(site, kind="corner", piece=tip, place=())
        else:
            corner = replace(site, kind="vertex", place=(min(place + flat.ends[1], 1.0),), vertex=flat.corners[1])
        return _instead(state, (i,), [(corner, load)])
    if flat.ends[0] > (-BESIDE if ahead else 0.0):
        first = place + flat.ends[0]
        corner = replace(site, kind="vertex", place=(first,), vertex=flat.corners[0])
        second = replace(site, kind="node", place=(first + BESIDE,))
        return _instead(state, (i,), [(corner, 0.0), (second, load)] if ahead else [(corner, load)])
    return None


def _down(setting: Setting, obstacle: Obstacle, state: State, i: int) -> State | None:
    """From a corner of the object to the flat that begins or ends there, where the face beside it has sunk in."""
    site, load = state.sites[i], float(state.loads[i][0])
    place, ahead = site.place[0], reach(setting, site)
    gaps = _gaps(setting, obstacle, state, site, place, obstacle.corners[site.vertex])
    away = BESIDE if gaps[1] < -_HAIR else -max(ahead, BESIDE)
    if min(gaps) >= -_HAIR or not 0 < place + away < 1:
        return None
    if away > 0 and ahead:
        return beside(state, i)
    return _instead(state, (i,), [(replace(site, kind="tangent", place=(place + away,), vertex=-1), load)])


def _off_tip(setting: Setting, obstacle: Obstacle, state: State, i: int) -> State | None:
    """From the tip's corner to the flat that the face beside it has come down on."""
    site, load = state.sites[i], float(state.loads[i][0])
    for face in (LOWER, UPPER):
        if setting.outline.tip_corner(face) != site.piece:
            continue
        down = replace(site, kind="tangent", piece=face, place=(1.0,))
        if _gaps(setting, obstacle, state, down, 1.0)[0] < -_HAIR:
            place = 1.0 - max(reach(setting, down), BESIDE)
            return _instead(state, (i,), [(replace(down, place=(place,)), load)])
    return None


def _gaps(
    setting: Setting, obstacle: Obstacle, state: State, site: Site, place: float, through: complex | None = None
) -> list[float]:
    """How far the face is outside the object before a place and behind it, once it goes through the touched point."""
    u = np.clip(np.array([place - BESIDE, place, place + BESIDE]), 0.0, 1.0)
    points, _ = _traced(setting, state, site.piece, u)
    touched = points[1] if through is None else through
    if through is None:  # the tip's corner: down to the surface
        gap, normal = obstacle.slope(points[1:2])
        touched -= complex(gap[0] * normal[0] / abs(normal[0]) ** 2)
    gaps = obstacle.gap(points + (touched - points[1]))
    return [float(gaps[0]), float(gaps[2])]


def reach(setting: Setting, site: Site) -> float:
    """How far (by L) beyond the place from which a face lies on a flat its force acts."""
    if site.grip is None:
        return 0.0
    ratio = site.grip.ratios(site.piece, site.middle)[0]
    half = float(setting.sections.thickness(np.array([min(max(site.middle, 0.0), 1.0)]))[0]) / 2
    return abs(ratio) * half if site.bends_away(ratio) else 0.0


def _traced(setting: Setting, state: State, piece: int, u: Array) -> tuple[Complex, Complex]:
    return setting.outline.trace(state.axis, np.full(u.size, piece), u, state.beam.segment_of(u))[:2]


def _flat(setting: Setting, obstacle: Obstacle, state: State, site: Site) -> _Flat | None:
    """The object's side that a contact is on, or that it has run off; None where it has no corners."""
    points, tangents = _traced(setting, state, site.piece, np.array(site.place))
    along = tangents / np.abs(tangents)
    away = obstacle.corners - points[0]
    x, y = dot(along, away), dot(outward(site.piece, along), away)
    line = np.flatnonzero(np.abs(y) < _IN_LINE * (np.abs(x) + _IN_LINE))
    line = line[np.argsort(x[line])]
    sides = [_Flat((int(one), int(other)), (float(x[one]), float(x[other]))) for one, other in itertools.pairwise(line)]
    if not sides:
        return None
    middles = np.array([(obstacle.corners[a] + obstacle.corners[b]) / 2 for a, b in (s.corners for s in sides)])
    solid = [side for side, gap in zip(sides, obstacle.gap(middles), strict=True) if abs(gap) < _SAME]
    return min(solid, key=lambda side: max(side.ends[0], -side.ends[1]), default=None)


def _instead(state: State, gone: tuple[int, ...], come: list[tuple[Site, float]]) -> State:
    """The state with other contacts in the place of some, which hold like them."""
    found = instead(state, gone, [(site, [load]) for site, load in come])
    grip = found.sites[0].grip
    return found if grip is None else replace(found, sites=grip.law.grouped(found.sites))
