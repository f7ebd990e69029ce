"""An object rolls along a face from corner to corner: those that carry are found from those that carried before.

A polygon of many sides changes its corner with every step. The corner that lies lowest takes over from the one that it
has passed, without a new search for contacts; where two or more carry together, as shear lets neighbours do, one that
has sunk comes in and one that would have to pull goes.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gripper.arrays import Array, Index
from gripper.beam.axis import Axis
from gripper.contact.features import neighbours
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import dot, outward
from gripper.contact.site import Site, corners_of
from gripper.statics.equilibrium import Equilibrium, Setting, State
from gripper.statics.newton import settle
from gripper.statics.patches import DECAYED, decay_length, pressure_modes, spread
from gripper.statics.sampling import DEPTH

NEAR = 0.15
"""Of L: how far along a face an object rolls in a step."""
_ROLLS = 8
_FLUSH = 0.8  # of sqrt(EI / GA): where Newton's method starts from
_SIDE = 2.0  # of sqrt(EI / GA): how far a side is looked at
_HAIR = 1e-9  # of L
_LOOKS = 17  # at a side between two corners
_FEET = 4  # Newton steps to the feet of normals
_SETTLED = 1e-4  # of L: what such a step changes of a height is its square


def rolled_on(setting: Setting, equilibrium: Equilibrium, order: int, *, judged: bool = False) -> Equilibrium:
    """The equilibrium in which the object has rolled on to the corners that carry it.

    Where these do not come to rest it is left as far as it came: its penetration tells.

    Raises
    ------
    NoEquilibriumError
        Where Newton does not converge with one of the sets of corners.
    """
    sites = equilibrium.state.sites
    if not any(site.kind == "vertex" for site in sites) or sites[0].grip is not None:
        return equilibrium
    tried = {_named(sites)}
    for _ in range(_ROLLS):
        following = _next(setting, equilibrium, tried)
        if following is None:
            break
        tried.add(_named(following.sites))
        found = settle(setting, equilibrium.obstacle, following, order, judged=judged)
        way, rounds = equilibrium.correction + found.correction, equilibrium.iterations + found.iterations
        equilibrium = replace(found, correction=way, iterations=rounds)
    return equilibrium


def rolled_ahead(setting: Setting, obstacle: Obstacle, state: State) -> State:
    """A guess with the corners of the object that lie lowest in it: Newton need not hold the old ones first.

    Of neighbours that carried together and are passed by now the lowest one carries what they did.
    """
    sites, loads, keep = list(state.sites), state.loads, [True] * len(state.sites)
    for i, site in enumerate(sites):
        if site.kind != "vertex" or site.grip is not None:
            continue
        group = neighbours(state.sites, i, NEAR)
        if i != max(group, key=lambda j: float(loads[j][0])):
            continue
        lowest = _lowest(setting, obstacle, state.axis, site)
        still = len(group) > 1 and lowest is not None and any(sites[j].vertex == lowest.vertex for j in group)
        if lowest is None or still or (len(group) > 1 and any(other.kind != "vertex" for other in sites)):
            continue  # where there is a pressure beside them, it goes on with them
        sites[i], loads[i] = lowest, np.array([sum(float(loads[j][0]) for j in group)])
        for j in group:
            keep[j] = j == i
    if all(keep) and sites == list(state.sites):
        return state
    return replace(state, sites=tuple(sites), multipliers=np.concatenate(loads)).keeping(keep)


def _named(sites: Sequence[Site]) -> frozenset[tuple[str, int, int]]:
    """A set of contacts, whatever their places."""
    return frozenset((site.kind, site.piece, site.vertex) for site in sites)


def _next(setting: Setting, equilibrium: Equilibrium, tried: set[frozenset[tuple[str, int, int]]]) -> State | None:
    """The state with another set of corners, none that was tried; None where all is well or nothing new is left."""
    state = equilibrium.state
    corners = [i for i, site in enumerate(state.sites) if site.kind == "vertex"]
    if not corners:
        return None
    weakest = min(corners, key=lambda i: float(state.loads[i][0]))
    if state.loads[weakest][0] < 0:
        less = _without(setting, state, weakest)
        return None if less is None or _named(less.sites) in tried else less
    for i in corners:
        sunk = _lowest(setting, equilibrium.obstacle, state.axis, state.sites[i])
        if sunk is None or any((s.piece, s.vertex) == (sunk.piece, sunk.vertex) for s in state.sites):
            continue
        passed = replace(state, sites=(*state.sites[:i], sunk, *state.sites[i + 1 :]))
        both = replace(state, sites=(*state.sites, sunk), multipliers=np.append(state.multipliers, 0.0))
        alone = len(neighbours(state.sites, i, NEAR)) == 1
        for choice in (passed, both) if alone else (both,):
            if _named(choice.sites) not in tried:
                return choice
    side = _between(setting, equilibrium) or _before(setting, equilibrium)
    return None if side is None or _named(side.sites) in tried else side


def _between(setting: Setting, equilibrium: Equilibrium) -> State | None:
    """The state that touches the side between two corners where both carry and the side has sunk in between them."""
    state = equilibrium.state
    order = sorted(range(len(state.sites)), key=lambda i: (state.sites[i].piece, state.sites[i].place))
    for i, j in itertools.pairwise(order):
        one, other = state.sites[i], state.sites[j]
        if one.kind != "vertex" or j not in neighbours(state.sites, i, NEAR):
            continue
        u, gaps = _gaps(setting, equilibrium, one, (one.place[0], other.place[0]))
        if gaps.min() >= (-DEPTH / 2 if j in neighbours(state.sites, i) else -_HAIR):
            continue  # corners that are near carry as one, whatever is between them
        forces = float(state.loads[i][0]), float(state.loads[j][0])
        if setting.theory == "bending":
            touch = Site("tangent", one.piece, (float(u[np.argmin(gaps)]),))
            return instead(state, (i, j), [(touch, [sum(forces)])])
        return instead(state, (i, j), _flush(setting, one, other, forces))
    return None


def _before(setting: Setting, equilibrium: Equilibrium) -> State | None:
    """With shear, the state that lies flush on the side before a corner that carries, where that side has sunk in."""
    state = equilibrium.state
    tails = {(site.piece, site.vertex) for site in state.sites if site.kind in ("tail", "span")}
    for i, site in enumerate(state.sites):
        if setting.theory == "bending" or site.kind != "vertex" or not site.on_face:
            continue
        near = max(site.place[0] - _SIDE * decay_length(setting, site.place[0]), 0.0)
        sunk = (site.piece, site.vertex) not in tails and _gaps(setting, equilibrium, site, (near, site.place[0]))[1]
        if np.min(sunk) < -DEPTH / 2:
            force, decay = float(state.loads[i][0]), decay_length(setting, site.place[0])
            return instead(state, (i,), _tailed(setting, site, force, min(_FLUSH * decay, site.place[0] / 2)))
    return None


def _gaps(setting: Setting, equilibrium: Equilibrium, site: Site, ends: tuple[float, float]) -> tuple[Array, Array]:
    """Places along a stretch of the site's piece, and the gaps there."""
    beam, u = equilibrium.state.beam, np.linspace(*ends, _LOOKS)
    segment = beam.segment_of(u) if site.on_face else np.full(u.size, beam.segments - 1)
    points, *_ = setting.outline.trace(equilibrium.state.axis, np.full(u.size, site.piece), u, segment)
    return u, equilibrium.obstacle.gap(points)


def instead(state: State, gone: tuple[int, ...], come: list[tuple[Site, list[float]]]) -> State:
    """The state with other contacts in the place of some, with their multipliers."""
    rest = [k for k in range(len(state.sites)) if k not in gone]
    loads = [*(state.loads[k] for k in rest), *(np.array(load) for _, load in come)]
    sites = (*(state.sites[k] for k in rest), *(site for site, _ in come))
    return replace(state, sites=sites, multipliers=np.concatenate(loads))


def _flush(setting: Setting, one: Site, other: Site, forces: tuple[float, float]) -> list[tuple[Site, list[float]]]:
    """Contacts of a face that lies flush between two corners, or up to the farther one, with their multipliers.

    Over the flush length h the shear force falls as cosh, the moment as sinh, and both end with the farther corner's
    force alone, l = sqrt(EI / GA). Where h is the side, the moment at the nearer corner is N l tanh(h / l); the farther
    of two corners that carry alone has less than that by its lever where the nearer one carries, too.
    """
    decay, total, side = decay_length(setting, other.place[0]), sum(forces), other.place[0] - one.place[0]
    if forces[1] * side >= total * decay * float(np.tanh(side / decay)):
        return _tailed(setting, other, total, min(_FLUSH * decay, side / 2))
    span = replace(one, kind="span", place=(one.place[0], other.place[0]), vertex=other.vertex)
    span = replace(span, modes=pressure_modes(setting, span, flat=True)[0])
    last = forces[1] * side / (decay * float(np.sinh(side / decay)))
    pressed = last * (float(np.cosh(side / decay)) - 1)
    return [(one, [total - last - pressed]), (span, spread(pressed, span)), (other, [last])]


def _tailed(setting: Setting, corner: Site, force: float, length: float) -> list[tuple[Site, list[float]]]:
    """Contacts of a face that lies flush over a length up to a corner: Newton's method finds it from far away."""
    end = corner.place[0]
    tail = replace(corner, kind="tail", place=(end - length, end))
    tail = replace(tail, modes=pressure_modes(setting, tail, flat=True)[0])
    left = force / float(np.cosh(length / decay_length(setting, end)))
    return [(tail, spread(force - left, tail)), (corner, [left])]


def _without(setting: Setting, state: State, pulling: int) -> State | None:
    """The state without a corner that would have to pull, where something beside it carries on; else None."""
    sites = list(state.sites)
    keep = [i != pulling for i in range(len(sites))]
    for i, site in enumerate(state.sites):
        near, far = corners_of(state.sites, i)
        if near == pulling:  # lifts off before the nearer corner
            sites[i] = replace(site, kind="tail")
        elif far == pulling and near is not None:  # turns about the nearer corner alone
            keep[i] = False
        elif far == pulling:  # what is left at the corner has decayed
            reach = DECAYED * decay_length(setting, site.place[0])
            sites[i] = replace(site, vertex=-1, place=(site.place[0], min(site.place[1], site.place[0] + reach)))
    changed = sites != list(state.sites) or sum(keep) < len(keep) - 1
    if not changed and len(neighbours(state.sites, pulling, NEAR)) == 1:
        return None
    return replace(state, sites=tuple(sites)).keeping(keep)


def strongest_alone(setting: Setting, equilibrium: Equilibrium, order: int) -> Equilibrium:
    """The equilibrium in which of neighbouring corners the strongest carries what they carry together.

    Together they exist on short ways of a motion only; the others are then sunk by a hair.

    Raises
    ------
    NoEquilibriumError
        Where Newton does not converge.
    """
    state = equilibrium.state
    loads = [float(load[0]) for load in state.loads]
    strongest = {i: max(neighbours(state.sites, i), key=lambda j: loads[j]) for i in range(len(state.sites))}
    for i in range(len(state.sites)):
        near, far = corners_of(state.sites, i)
        if far is not None:  # a pressure that ends in a corner's force
            strongest[i] = strongest[far if near is None else near]
    keep = [strongest[i] == i for i in strongest]
    if all(keep):
        return equilibrium
    gathered = [np.append(sum(loads[j] for j in strongest if strongest[j] == i), state.loads[i][1:]) for i in strongest]
    alone = replace(state, multipliers=np.concatenate(gathered)).keeping(keep)
    return settle(setting, equilibrium.obstacle, alone, order)


def _lowest(setting: Setting, obstacle: Obstacle, axis: Axis, site: Site) -> Site | None:
    """The corner that the object rolls down to from one of its corners, if it has sunk through the piece."""
    numbers, feet, heights = corners_along(setting, obstacle, axis, site)
    if site.vertex not in numbers:
        return None
    at = int(np.argmax(numbers == site.vertex))
    for way in (1, -1):
        while 0 <= at + way < len(heights) and heights[at + way] < heights[at]:
            at += way
    if heights[at] >= -DEPTH / 2:
        return None
    return replace(site, place=(float(feet[at]),), vertex=int(numbers[at]))


def corners_along(setting: Setting, obstacle: Obstacle, axis: Axis, site: Site) -> tuple[Index, Array, Array]:
    """The object's corners over a piece near one of them, in their order along it.

    Returns
    -------
    Their numbers, the feet of the normals from them, and how far outside they are (by L, negative: sunk in).
    """
    away = obstacle.corners - obstacle.corners[site.vertex]
    numbers = np.flatnonzero(np.abs(away) < NEAR)
    corners, end = obstacle.corners[numbers], setting.outline.pieces[site.piece].length
    piece, u = np.full(numbers.size, site.piece), np.full(numbers.size, site.place[0])
    last = np.full(numbers.size, axis.beam.segments - 1)
    for _ in range(_FEET):
        segment = axis.beam.segment_of(u) if site.on_face else last
        place, tangent, _ = setting.outline.trace(axis, piece, u, segment)
        steps = dot(corners - place, tangent) / np.abs(tangent) ** 2
        u = (u + steps).clip(0.0, end)
        if np.abs(steps).max() < _SETTLED:
            break
    heights = dot(corners - place, outward(site.piece, tangent))
    deepest = setting.sections.thickness(u) / 2 if site.on_face else np.full(u.shape, end / 2)
    over = np.flatnonzero((u > 0) & (u < end) & (heights > -deepest))
    over = over[np.argsort(u[over], kind="stable")]
    return numbers[over], u[over], heights[over]
