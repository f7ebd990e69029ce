"""One contact takes over from another: on the way both touch, however short that way is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gripper.contact.features import Feature, gone_and_come
from gripper.contact.site import pointed as as_point
from gripper.motion.branch import Along, Path, branch_from, number, pointed
from gripper.motion.events import moves
from gripper.motion.releasing import let_go
from gripper.motion.turning import adjacent
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.lying import beside
from gripper.statics.newton import settle
from gripper.statics.snap import distance
from gripper.statics.verified import Verified, verify

_ANOTHER = 0.05  # of L: a contact that is so much further away is another one


def exchanged(setting: Setting, path: Path, old: Along, new: Along, order: int) -> tuple[float, Verified] | None:
    """Half-way between where a contact comes and where another one goes, both on the way from old to new.

    None where that is not what happens between them.
    """
    gone, come = gone_and_come(old.equilibrium.state.sites, new.equilibrium.state.sites, moves(old, new))
    if len(gone) != 1 or len(come) != 1:
        return None
    lies = _lies_down(old, new, (gone[0], come[0]))
    if not lies and _rolls(setting, old, new, (gone[0], come[0])):
        return None
    try:
        both, won, lost = (_beside if lies else _both)(setting, old, new, (gone[0], come[0]), order)
        branch = branch_from(setting, path, both, order)
        touch = let_go(branch, won, new.parameter, old.parameter)
        release = None if touch is None else let_go(branch, lost, touch, new.parameter)
        if touch is None or release is None or (release - touch) * (new.parameter - old.parameter) <= 0:
            return None
        middle = (touch + release) / 2
        return middle, verify(setting, branch.at(middle))
    except NoEquilibriumError:
        return None


def _rolls(setting: Setting, old: Along, new: Along, contacts: tuple[Feature, Feature]) -> bool:
    """Whether a contact may have rolled on to another: it is no further away than the finger has moved, or hardly."""
    points = [
        at.equilibrium.linear.points[number(at, contact)] for at, contact in zip((old, new), contacts, strict=True)
    ]
    moved = distance(old.equilibrium.state, new.equilibrium.state)
    near = abs(points[1].mean() - points[0].mean()) < _ANOTHER + 2 * moved
    return near and adjacent(setting, *contacts)


def _lies_down(old: Along, new: Along, contacts: tuple[Feature, Feature]) -> bool:
    """Whether a face comes to lie on a flat from the corner at which that begins, or gets up from it to there."""
    sites = [at.equilibrium.state.sites[number(at, contact)] for at, contact in zip((old, new), contacts, strict=True)]
    corner, flank = sorted(sites, key=lambda site: site.kind != "vertex")
    same = (corner.kind, flank.kind) == ("vertex", "tangent") and corner.piece == flank.piece
    return same and flank.flush and corner.middle < flank.middle


def _beside(
    setting: Setting, old: Along, new: Along, contacts: tuple[Feature, Feature], order: int
) -> tuple[Along, int, int]:
    """The corner at which a flat begins with the place beside it; the numbers of what came of both and what went."""
    came = contacts[1][0] == "vertex"
    at, corner = (new, contacts[1]) if came else (old, contacts[0])
    equilibrium = at.equilibrium
    found = settle(setting, equilibrium.obstacle, beside(equilibrium.state, number(at, corner)), order)
    sites = found.state.sites
    first = next(i for i, site in enumerate(sites) if site.kind == "vertex" and site.vertex == corner[2])
    second = len(sites) - 1
    return Along(at.parameter, found), *((first, second) if came else (second, first))


def _both(
    setting: Setting, old: Along, new: Along, contacts: tuple[Feature, Feature], order: int
) -> tuple[Along, int, int]:
    """The new contacts with the lost one held, which may pull; and the numbers of the one that came and of that."""
    equilibrium = pointed(setting, new.equilibrium, order)
    held = old.equilibrium.state.sites[number(old, contacts[0])]
    held = replace(as_point(held), grip=held.grip)
    state = equilibrium.state
    came = state.sites[number(new, contacts[1])]
    lost, won = len(state.sites), state.sites.index(came)
    sites = (*state.sites, held) if setting.friction is None else setting.friction.grouped((*state.sites, held))
    guess = State(state.beam, state.z, sites, np.append(state.multipliers, 0.0))
    return Along(new.parameter, settle(setting, equilibrium.obstacle, guess, order)), won, lost
