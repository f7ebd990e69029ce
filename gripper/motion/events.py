"""What changes between two poses of a motion, and at which value of its parameter."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gripper.contact.features import apart_from, feature_name, gone_and_come, stayed
from gripper.contact.linear import linearise
from gripper.contact.obstacle import Obstacle
from gripper.contact.site import Site
from gripper.motion.branch import APART, SHARP, Along, Path, bracketed, branch_from, joined, pointed
from gripper.motion.releasing import released
from gripper.motion.turning import adjacent, changed, rolled_apart
from gripper.statics.candidates import resolved
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State, solved
from gripper.statics.nearby import least_gaps
from gripper.statics.newton import unloaded
from gripper.statics.rolling import NEAR
from gripper.statics.verified import objection

STRUT = "met head-on the finger is a strut and buckles: to which side is undecided by statics"
_GRAZED = 1e-9  # of L: contacts that only graze are none
_ROUNDS = 8  # of Newton's method, of which four or five are needed


Kind = Literal["touch", "release", "change", "snap", "stick", "slip"]
"""What an event is."""


class MovedOnError(NoEquilibriumError):
    """The first contact is none of those at the end of the step."""


@dataclass(frozen=True)
class Change:
    """Something that happened at a value of the path's parameter."""

    parameter: float
    kind: Kind
    detail: str

    def within(self, start: float, stop: float) -> float:
        """Where it is on its step: a contact may be kept a little beyond its end, which then lies before it."""
        return sorted((start, self.parameter, stop))[1]


def changes(setting: Setting, path: Path, old: Along, new: Along, order: int, *, located: bool = True) -> list[Change]:
    """Touch, release and change of face, edge or corner between two neighbouring poses, located on the parameter.

    Where nobody asks for the places, those that the proof of the branch does not need are not located.

    Raises
    ------
    NoEquilibriumError
        Where the branches do not lead to the event: the step is too long, or leads to another branch.
    """
    before, after, outline = old.equilibrium.state.sites, new.equilibrium.state.sites, setting.outline
    if stayed(before, after):
        return []
    gone, come = gone_and_come(before, after, moves(old, new))
    out: list[Change] = []
    for lost in list(gone):
        won = next((f for f in come if lost in gone and adjacent(setting, lost, f)), None)
        if won is not None:
            where = changed(setting, path, (old, new), (lost, won), order, located=located)
            out.append(Change(where, "change", f"{feature_name(outline, lost)} to {feature_name(outline, won)}"))
            gone, come = apart_from(before, gone, lost), apart_from(after, come, won)
    if come and not before:
        come = [come[0], *apart_from(after, come, come[0])]
    if len(out) + len(gone) + len(come) > 1:
        raise NoEquilibriumError("several contacts change within one step")
    for won in come:
        if before:
            where = released(setting, path, new, old, won, order)
        else:
            where, touched = _first(setting, path, old, new, order)
            won = (*won[:2], touched.vertex, won[3]) if won[0] == "vertex" else won
        out.append(Change(where, "touch", feature_name(outline, won)))
        if not before and on_end(setting, touched):
            out.append(Change(where, "snap", STRUT))
    for lost in gone:
        where = released(setting, path, old, new, lost, order)
        out.append(Change(where, "release", feature_name(outline, lost)))
    return out


def check_unbroken(setting: Setting, path: Path, old: Along, new: Along, order: int) -> None:
    """Contacts that were found anew, not predicted, are those of the old branch all the way, if they look like them.

    Raises
    ------
    NoEquilibriumError
        Where the old branch ends elsewhere, or something else touches in between: what came has gone again.
    """
    kinds = [[(site.kind, site.piece, site.vertex) for site in at.equilibrium.state.sites] for at in (old, new)]
    if kinds[0] != kinds[1]:
        return
    branch = branch_from(setting, path, old, order)
    joined(setting, path, Along(new.parameter, branch.at(new.parameter)), new, order)
    between = branch.at((old.parameter + new.parameter) / 2)
    if objection(setting, between) or not survey(setting, between.obstacle, between.state).clear:
        raise NoEquilibriumError("something else touches before")


def moves(old: Along, new: Along) -> list[float]:
    """How far each contact should move along its piece by the tangent; a limit point tells nothing."""
    try:
        rates, first, out = old.equilibrium.tangent()[2], 0, []
    except np.linalg.LinAlgError:
        return []
    for site in old.equilibrium.state.sites:
        own = rates[first : first + site.unknown_places]
        out.append(float(own.mean() if own.size else 0.0) * (new.parameter - old.parameter))
        first += site.unknowns
    return out


def _first(setting: Setting, path: Path, old: Along, new: Along, order: int) -> tuple[float, Site]:
    """Where the free finger is touched first, and by what: a contact that the new pose still has, or has rolled on."""
    sites = new.equilibrium.state.sites

    @functools.cache  # of some parameters both are asked for, or one of them again
    def seen(parameter: float) -> tuple[list[tuple[float, Site]], set[int]]:
        obstacle = setting.obstacle(path.frame(parameter))
        state = _free(setting, obstacle, old)
        found = least_gaps(setting, obstacle, state, survey(setting, obstacle, state, brief=True))
        return found, _kept(setting, found, sites)

    def least(parameter: float, *, kept: bool) -> tuple[float, Site]:
        found, own = seen(parameter)
        mine = [gap for i, gap in enumerate(found) if (i in own) == kept]
        return min(mine, key=lambda gap: gap[0], default=(np.inf, sites[0]))

    (deepest, site), ends = least(new.parameter, kept=True), (old.parameter, new.parameter)
    if np.isinf(deepest):
        raise MovedOnError("the first contact has moved on within the step")
    where = _met(setting, path, old, site, ends) if deepest < 0 else None
    if where is None or least(where, kept=True)[0] < -_GRAZED:
        where = bracketed(lambda parameter: min(least(parameter, kept=True)[0], 1.0), *ends)
    if least(where, kept=False)[0] < -_GRAZED:
        raise MovedOnError("the first contact has moved on within the step")
    touched = least(where, kept=True)[1]
    points = replace(new, equilibrium=pointed(setting, new.equilibrium, order))
    obstacle = setting.obstacle(path.frame(where))
    free = replace(old.equilibrium, state=_free(setting, obstacle, old), obstacle=obstacle)
    rolled = touched.kind == "vertex" and all(site.vertex != touched.vertex for site in points.equilibrium.state.sites)
    apart = rolled_apart(old, new) if rolled else APART
    return joined(setting, path, Along(where, free), points, order, apart), touched


def _met(setting: Setting, path: Path, old: Along, site: Site, ends: tuple[float, float]) -> float | None:
    """Where a place of the free finger that lies in the object at the second end is met, the least gap beside it.

    By Newton's method on the place and the parameter; None where that does not tell.
    """
    state, (start, at), way = old.equilibrium.state, ends, ends[1] - ends[0]
    if site.kind == "node" or not (setting.loads is None or setting.loads.steady):
        return None
    site = resolved(setting, site)
    for _ in range(_ROUNDS):
        obstacle = setting.obstacle(path.frame(at))
        lin = linearise(state.beam, state.z, setting.outline, obstacle, (site,), np.zeros(1), kinks=False)
        slopes = np.concatenate([lin.value_slopes, lin.residual_slopes])
        rates = np.concatenate(lin.rates()[:2])
        step = solved(np.column_stack([slopes, rates]), -np.concatenate([lin.values, lin.residuals]))
        if step is None or not 0 <= (at + step[-1] - start) / way <= 1:
            return None
        site, at = site.moved(site.coordinates + step[:-1]), at + float(step[-1])
        if site.place and not 0 <= site.place[0] <= setting.outline.pieces[site.piece].length:
            return None
        if abs(step[-1]) <= SHARP * abs(way):
            return at
    return None


def _free(setting: Setting, obstacle: Obstacle, old: Along) -> State:
    """The finger that nothing touches, at a pose near to one where it is free: the same, unless its loads change."""
    state = old.equilibrium.state
    if setting.loads is None or setting.loads.steady:
        return state
    return unloaded(setting, obstacle, state.beam.order, state).state


def touched_at(setting: Setting, path: Path, old: Along, stop: float) -> float | None:
    """Where the free finger is touched first; None where it is only grazed."""

    def least(parameter: float) -> tuple[float, Site | None]:
        return _nearest(setting, setting.obstacle(path.frame(parameter)), old)

    deepest, site = least(stop)
    if site is None or deepest >= -_GRAZED:
        return None
    where = _met(setting, path, old, site, (old.parameter, stop))
    if where is not None and least(where)[0] >= -_GRAZED:
        return where
    return bracketed(lambda parameter: least(parameter)[0] + _GRAZED, old.parameter, stop)


def _nearest(setting: Setting, obstacle: Obstacle, old: Along) -> tuple[float, Site | None]:
    """The least gap of the free finger, and where it is; 1 where it is far from the object."""
    state = _free(setting, obstacle, old)
    found = least_gaps(setting, obstacle, state, survey(setting, obstacle, state, brief=True))
    return min(found, key=lambda gap: gap[0], default=(1.0, None))


def head_on(setting: Setting, path: Path, free: Along, parameter: float) -> bool:
    """Whether the free finger is met on its end face, where it is a strut."""
    return on_end(setting, _nearest(setting, setting.obstacle(path.frame(parameter)), free)[1])


def on_end(setting: Setting, site: Site | None) -> bool:
    """Whether a place is on the end face, and not at its corner."""
    site = site and resolved(setting, site)
    return site is not None and site.kind == "tangent" and setting.outline.place(site.piece, np.zeros(1))[0] == "tip"


def _kept(setting: Setting, found: list[tuple[float, Site]], sites: tuple[Site, ...]) -> set[int]:
    """Which of the places that come nearest to the object are contacts of the next pose: on a piece the nearest."""
    kept: set[int] = set()
    for site in sites:
        same = [i for i, (_, touched) in enumerate(found) if _same(setting, touched, site)]
        same.sort(key=lambda i: abs(found[i][1].middle - site.middle))
        kept |= set(same if site.kind == "vertex" else same[:1])
    return kept


def _same(setting: Setting, touched: Site, site: Site) -> bool:
    """Whether a first contact, or the corner that it is at, is one of the next pose, or the object rolls on from it."""
    piece = touched.piece
    if touched.kind == "tangent":
        corner = setting.outline.corner_at(piece, touched.place[0])
        piece = piece if corner is None else corner
    if touched.kind == site.kind == "vertex" and touched.vertex != site.vertex:
        return piece == site.piece and abs(touched.middle - site.middle) < NEAR
    return piece == site.piece and touched.vertex == site.vertex
