"""A contact goes over to the next: where it reaches the end of its piece, or the object rolls on to another corner."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.arrays import Complex
from gripper.contact.features import Feature
from gripper.contact.site import Site
from gripper.motion.branch import SHARP, Along, Path, bracketed, branch_from, joined, number
from gripper.motion.pinned import Pin
from gripper.motion.releasing import released
from gripper.statics.contact_forces import normal_force
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.statics.lying import reach
from gripper.statics.nearby import vertex_height
from gripper.statics.rolling import corners_along, strongest_alone
from gripper.statics.snap import distance

_SHORT = 0.999  # of the way to an end that must not be passed
_STEPS = 30
_OVERSHOT = 1.0  # of a step: a contact may have been kept beyond the end of its piece, within the penetration allowed
_ROLLED = 1e-3  # of L: the same where an object rolls over a corner: between corners its side touches, too
_ROLLS = 0.25  # of a step: the same from corner to corner
_SKIPPED = 1e-6  # of L: where a corner is sunk deeper others have carried in between
_BESIDE = 1e-6  # of L: how far from a corner its side is looked at
_ASIDE = 0.5  # of the way along it: corners further aside are of other parts of the object
_SHORTLY = 1e-2  # of a step
_MEETING = 1e-9  # of L: where pieces of the outline meet


def adjacent(setting: Setting, lost: Feature, won: Feature) -> bool:
    """Whether a contact may roll on: to the corner at an edge's end, or back; to another of the object's corners."""
    if "corner" not in (lost[0], won[0]) and lost[2] != won[2]:
        return lost[1] == won[1]  # the object rolls along a face, from its corner on to its side or to the next corner
    if (lost[0] == "corner") == (won[0] == "corner") and lost[0] != "vertex":
        return False
    return setting.outline.meet(lost[1], won[1])


def changed(
    setting: Setting,
    path: Path,
    poses: tuple[Along, Along],
    contact: tuple[Feature, Feature],
    order: int,
    *,
    located: bool = True,
) -> float:
    """A contact that has a place on its piece tells by its reaching the end; a corner by its multiplier."""
    (old, new), (lost, won) = poses, contact
    if lost[0] == won[0] == "vertex" and lost[1] == won[1]:
        return _rolled(setting, path, poses, won, order, located=located)
    if "corner" not in (lost[0], won[0]) and lost[0] != won[0]:
        return _turned(
            setting, path, (old, new) if lost[0] == "vertex" else (new, old), (lost, won), order, new.parameter
        )
    if lost[0] != "corner":
        return _departed(setting, path, old, new, (lost, won), order)
    if won[0] != "corner" and not any(site.kind == "tail" for site in old.equilibrium.state.sites):
        return _departed(setting, path, new, old, (won, lost), order)
    return released(setting, path, old, new, lost, order)


def _departed(
    setting: Setting, path: Path, known: Along, other: Along, pair: tuple[Feature, Feature], order: int
) -> float:
    """Where a contact's place reaches the end of its piece, on to another: steps that stop a little short of it."""
    i = number(known, pair[0])
    if not known.equilibrium.state.sites[i].unknown_places:
        raise NoEquilibriumError("a contact without a place of its own ends")
    distant = setting.outline.ends(pair[0][1])[-1]
    far = min(abs(distant - end) for end in setting.outline.ends(pair[1][1])) < _MEETING
    branch, at, short = branch_from(setting, path, known, order), known.parameter, _SHORT
    stop, way = other.parameter, other.parameter - known.parameter
    pin = _at_end(setting, known.equilibrium, i, far)
    where = branch.pinned(at, pin, (at, stop + _OVERSHOT * way)) if pin else None
    if where is not None:
        return joined(setting, path, Along(where, branch.at(where)), other, order)
    for _ in range(_STEPS):  # where the equations are all but singular: equilibrium by equilibrium
        ahead, rate = _from_end(setting, branch.at(at), i, far)
        step = -ahead / rate * short if rate else way
        if abs(step) <= SHARP * abs(way):
            return joined(setting, path, Along(at, branch.at(at)), other, order)
        if not 0 <= (at + step - known.parameter) / way <= 1 + _OVERSHOT:
            step = stop + _OVERSHOT * way - at if step * way > 0 else known.parameter - at
            if abs(step) <= SHARP * abs(way):
                raise NoEquilibriumError("a contact reaches the end of its face or edge beyond the step")
        try:
            branch.at(at + step)
            at, short = at + step, _SHORT
        except NoEquilibriumError:
            short /= 2
    raise NoEquilibriumError("a contact does not reach the end of its face or edge")


def _at_end(setting: Setting, equilibrium: Equilibrium, i: int, far: bool) -> Pin | None:
    """A contact's place at an end of its piece, the far one or the near one; None where that end is there already."""
    state = equilibrium.state
    site, first = state.sites[i], state.multipliers.size + sum(site.unknowns for site in state.sites[:i])
    if not far:
        return Pin(first, 0.0)
    if site.unknown_places < len(site.place):
        return None
    return Pin(first + site.unknown_places - 1, setting.outline.pieces[site.piece].length - _beyond(setting, site))


def _beyond(setting: Setting, site: Site) -> float:
    """How far before the end of its piece a contact goes over: where its force acts there."""
    return reach(setting, site) if site.grip is not None and site.grip.flush else 0.0


def _from_end(setting: Setting, equilibrium: Equilibrium, i: int, far: bool) -> tuple[float, float]:
    """How far a contact is from an end of its piece, the far one or the near one, and the rate of that."""
    sites = equilibrium.state.sites
    site, first = sites[i], sum(site.unknowns for site in sites[:i])
    rates = equilibrium.tangent()[2][first : first + site.unknown_places]
    if far:
        end = setting.outline.pieces[site.piece].length - _beyond(setting, site)
        return end - site.place[-1], -float(rates[-1])
    return site.place[0], float(rates[0])


def _rolled(
    setting: Setting, path: Path, poses: tuple[Along, Along], won: Feature, order: int, *, located: bool
) -> float:
    """Where the object's next corner comes down on a face: of several that pass within the step, about where.

    Neighbours that carry together are followed as the strongest of them alone: together they exist on short ways only.
    """
    old, new = poses
    alone = replace(old, equilibrium=strongest_alone(setting, old.equilibrium, order))
    branch, place = branch_from(setting, path, alone, order), new.equilibrium.state.sites[number(new, won)].place
    if distance(branch.at(new.parameter).state, new.equilibrium.state) > rolled_apart(old, new):
        raise NoEquilibriumError("the step leads to another branch")
    if not located:
        return new.parameter
    corner = Site("vertex", won[1], place, won[2])

    def height(parameter: float) -> float:
        there = branch.at(parameter)
        return vertex_height(setting, there.obstacle, there.state.axis, corner)

    start, stop = old.parameter, new.parameter
    first, last = height(start), height(stop)
    if first <= 0 or last >= 0:  # it carried before the other had gone, or they still carry together
        return start if first <= 0 else stop
    about = start + (stop - start) * first / (first - last)
    there = branch.at(about)
    if corners_along(setting, there.obstacle, there.state.axis, corner)[2].min(initial=0.0) < -_SKIPPED:
        return about
    return bracketed(height, start, stop)


def rolled_apart(old: Along, new: Along) -> float:
    """By how much (by L) shapes held by two corners may differ where an object rolls from one to the other."""
    return max(_ROLLED, _ROLLS * distance(old.equilibrium.state, new.equilibrium.state))


def _corner_between(corners: Complex, at: complex, touched: complex) -> bool:
    """Whether an object's outline has another corner on its way from one of its corners to a place on it."""
    way = touched - at
    passed = (corners - at) / way  # along the way, and across it, in parts of it
    return bool(np.any((passed.real > _MEETING) & (passed.real < 1 - _MEETING) & (np.abs(passed.imag) < _ASIDE)))


def _turned(
    setting: Setting, path: Path, pair: tuple[Along, Along], contact: tuple[Feature, Feature], order: int, end: float
) -> float:
    """Where a face that turns about a corner of the object comes down on the side beside it.

    Where it passes other corners within the step, it is the step's end.
    """
    at_corner, beside = pair
    corner, side = contact if contact[0][0] == "vertex" else contact[::-1]
    known = beside.equilibrium
    at, touched = known.obstacle.corners[corner[2]], complex(known.linear.points[number(beside, side)].mean())
    if _corner_between(known.obstacle.corners, at, touched):  # it is another corner's side
        alone = replace(at_corner, equilibrium=strongest_alone(setting, at_corner.equilibrium, order))
        held = branch_from(setting, path, alone, order).at(beside.parameter)
        if distance(held.state, known.state) > rolled_apart(at_corner, beside):
            raise NoEquilibriumError("the step leads to another branch")
        return end
    branch, i = branch_from(setting, path, at_corner, order), number(at_corner, corner)
    away = touched - at
    beginning = at + away / abs(away) * _BESIDE
    turned = np.exp(1j * known.obstacle.frame.angle)
    slope, along = complex(known.obstacle.slope(np.array([beginning]))[1][0]) / turned, away / abs(away) / turned
    towards = float(np.sign((slope.conjugate() * along).imag))  # the force turns as it leaves the corner

    def turn(parameter: float) -> float:
        there = branch.at(parameter)
        pressing = normal_force(there, i) / np.exp(1j * there.obstacle.frame.angle)
        return float((slope.conjugate() * pressing).imag) * towards

    # it may have been kept at the corner a hair beyond, within the penetration allowed
    beyond = turn(at_corner.parameter) >= 0
    where = at_corner.parameter if beyond else bracketed(turn, at_corner.parameter, beside.parameter)
    there, further = branch.at(where), where + _SHORTLY * (beside.parameter - where)
    other = branch_from(setting, path, beside, order).at(further)
    if distance(there.state, other.state) > _ROLLED:
        raise NoEquilibriumError("the step leads to another branch")
    return where
