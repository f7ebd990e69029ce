"""The equations that hold where finger and object touch, all contacts in one pass over outline and object."""

from __future__ import annotations

import functools

import numpy as np

from gripper.arrays import Array, Index
from gripper.beam.axis import Axis
from gripper.beam.strains import Beam
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import Outline
from gripper.contact.rows import System
from gripper.contact.site import CUTS, Site, own_segment, pressure_rule
from gripper.contact.stations import Stations, stations

_AT_BREAK = 0.02  # a force this near to a break is the break's own: its segments were cut there


def linearise(
    beam: Beam,
    z: Array,
    outline: Outline,
    obstacle: Obstacle,
    sites: tuple[Site, ...],
    multipliers: Array,
    *,
    kinks: bool = True,
) -> Linearisation:
    """Evaluate the contact equations of all sites in one pass over outline and object.

    With ``kinks`` a contact at a break takes the mean of both sides; without, its own segment alone.
    """
    if not sites:
        nothing = _nothing(beam.size)
        return nothing if obstacle.acting is None else nothing.pushed(obstacle.acting.push(Axis.of(beam, z)))
    queries = [_places(site, beam.order) for site in sites]
    u = np.concatenate(queries)
    piece = np.array([site.piece for site in sites]).repeat([q.size for q in queries])
    axis = Axis.of(beam, z)
    looked_at = _stations(axis, outline, piece, u, sites, queries, kinks)
    system = System(beam, sites, looked_at, obstacle)
    first = row = column = 0
    for site, places in zip(sites, queries, strict=True):
        span = slice(first, first + len(places))
        load = multipliers[row : row + site.modes]
        if site.kind == "vertex":
            system.add_vertex(site, first, row, column, load[0])
        elif site.spreads:
            system.add_patch(site, span, row, column, load)
        else:
            system.add_point(site, first, row, column, load[0])
        system.layout.append((span, row, column))
        first, row, column = span.stop, row + site.modes, column + site.unknowns
    if sites[0].grip is not None:
        from gripper.contact.rubbing import rub  # without friction it is not even read

        rub(system, u)
    hessian = looked_at.second_derivative(axis, system.pull)
    hessian += system.stiffened()
    if system.extra is not None:
        hessian += system.extra
    found = system.linearisation(hessian, queries)
    return found if obstacle.acting is None else found.pushed(obstacle.acting.push(axis))


@functools.cache
def _nothing(size: int) -> Linearisation:
    """The linearisation of a finger that touches nothing."""
    none, wide, square = np.zeros(0), np.zeros((0, size)), np.zeros((0, 0))
    forces = np.zeros(size) + 0j, none + 0j, none + 0j
    gaps, places, whole = (none, wide, square), (none, wide, square), np.zeros((size, size))
    still = none, none, np.zeros(size)
    return Linearisation(*gaps, *places, wide.T, wide.T, whole, lambda: still, *forces, (), (), (), wide)


def _places(site: Site, order: int) -> Array:
    """Where the outline is evaluated for a contact."""
    if not site.spreads:
        return np.array(site.place or (0.0,))
    a, b = site.place
    return a + (b - a) * _along(site.modes, order, site.unknown_places)


@functools.cache
def _along(modes: int, order: int, ends: int) -> Array:
    """The places of a pressure from 0 to 1: Gauss points, and the ends that are free."""
    return np.array([*((pressure_rule(modes, order)[0] + 1) / 2).tolist(), *(0.0, 1.0)[:ends]])


def _stations(
    axis: Axis, outline: Outline, piece: Index, u: Array, sites: tuple[Site, ...], queries: list[Array], kinks: bool
) -> Stations:
    beam = axis.beam
    left: list[int] = []
    right: list[int] = []
    for site, places in zip(sites, queries, strict=True):
        if site.modes in CUTS or site.lifts_off:
            inner = beam.segment_of(places - 1e-12).tolist()
            if site.lifts_off:  # its place tells by the face before it
                inner[-1] = _beside(beam, site.place[0])[0]
            left, right = left + inner, right + inner
            continue
        before, after = _segments(beam, site, kinks)
        left += [before] * len(places)
        right += [after] * len(places)
    if left == right:
        return stations(outline, axis, piece, u, np.array(left))
    return stations(outline, axis, np.tile(piece, 2), np.tile(u, 2), np.array(left + right)).folded()


def _segments(beam: Beam, site: Site, kinks: bool) -> tuple[int, int]:
    """The segments whose polynomials describe the outline before and after a contact."""
    if not site.on_face or not kinks or site.spreads:
        own = own_segment(beam, site)
        return own, own
    return _beside(beam, site.middle)


def _beside(beam: Beam, s: float) -> tuple[int, int]:
    """The segments before and after a place: the same one away from breaks."""
    nearest = min(range(beam.segments), key=lambda i: abs(beam.breaks[i] - s))
    if nearest and abs(beam.breaks[nearest] - s) < _AT_BREAK:
        return nearest - 1, nearest
    own = int(beam.segment_of(np.array([s]))[0])
    return own, own
