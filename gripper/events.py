"""What changes between two poses of a motion, and at which value of its parameter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, Protocol

import numpy as np
from scipy.optimize import brentq

from gripper.assemble import least_gaps, vertex_height
from gripper.certificate import survey
from gripper.contact import Kind, Site
from gripper.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, predicted, settle
from gripper.obstacle import Frame
from gripper.snap import distance

Feature = tuple[Literal["flank", "corner", "vertex"], int, int]
_SECANTS = 40
_SHORT = 0.999  # of the way to a root that must not be passed
_STEPS = 30
_SHORT = 0.999  # of the way to an end that must not be passed
_ROUND_OFF = 1e-13
STRUT = "met head-on the finger is a strut and buckles: to which side is undecided by statics"
_GRAZED = 1e-9  # of L: contacts that only graze are none
_HALVINGS = 4  # of a way along a branch
_DEPARTS = 0.5  # of a step: what it may differ from its prediction
_APART = 1e-4  # of L: shapes that differ by more are of different branches
_OVERSHOT = 1.0  # of a step: a contact may have been kept beyond the end of its piece, within the penetration allowed
_ROLLED = 1e-3  # of L: the same where an object rolls over a corner: between corners its side touches, too
_ROLLS = 0.25  # of a step: the same from corner to corner
_BESIDE = 1e-6  # of L: how far from a corner its side is looked at
_SHORTLY = 1e-2  # of a step
_MEETING = 1e-9  # of L: where pieces of the outline meet
_SHARP = 1e-10  # of the step: where an event is located to


class Path(Protocol):
    """Frames of the object along a parameter."""

    def frame(self, parameter: float) -> Frame:
        """The object's frame relative to the clamp."""
        ...


@dataclass(frozen=True)
class Change:
    """Something that happened at a value of the path's parameter."""

    parameter: float
    kind: Literal["touch", "release", "change", "snap", "stick", "slip"]
    detail: str


@dataclass(frozen=True, eq=False)
class Along:
    """An equilibrium and where on the path it stands."""

    parameter: float
    equilibrium: Equilibrium


def features(sites: tuple[Site, ...]) -> dict[Feature, int]:
    """What touches, and the number of its site; a patch that ends in the tip's corner is the corner."""
    kinds: dict[str, Literal["flank", "corner", "vertex"]] = {"corner": "corner", "vertex": "vertex"}
    return {
        (kinds.get(site.kind, "flank"), site.piece, site.vertex): i
        for i, site in enumerate(sites)
        if site.kind != "tail"
    }


def changes(setting: Setting, path: Path, old: Along, new: Along, order: int) -> list[Change]:
    """Touch, release and change of face, edge or corner between two neighbouring poses, located on the parameter.

    Raises
    ------
    NoEquilibriumError
        Where the branches do not lead to the event: the step is too long, or leads to another branch.
    """
    before, after = features(old.equilibrium.state.sites), features(new.equilibrium.state.sites)
    gone, come = [f for f in before if f not in after], [f for f in after if f not in before]
    out: list[Change] = []
    for lost in list(gone):
        won = next((f for f in come if _adjacent(setting, lost, f)), None)
        if won is not None:
            where = _changed(setting, path, old, new, lost, won, order)
            out.append(Change(where, "change", f"{_feature_name(setting, lost)} to {_feature_name(setting, won)}"))
            gone.remove(lost)
            come.remove(won)
    if len(out) + len(gone) + len(come) > 1:
        raise NoEquilibriumError("several contacts change within one step")
    for won in come:
        where = _released(setting, path, new, old, won, order) if before else _first(setting, path, old, new, order)
        out.append(Change(where, "touch", _feature_name(setting, won)))
        if not before and head_on(setting, path, old, where):
            out.append(Change(where, "snap", STRUT))
    for lost in gone:
        where = _released(setting, path, old, new, lost, order)
        out.append(Change(where, "release", _feature_name(setting, lost)))
    return out


def _joined(setting: Setting, path: Path, there: Along, known: Along, order: int, apart: float = _APART) -> float:
    """Where an event is, once the branch of a known equilibrium is seen to meet the event's.

    Raises
    ------
    NoEquilibriumError
        Where they do not meet: the step leads to another branch.
    """
    other = Branch(setting, path, known, order).at(there.parameter)
    if distance(there.equilibrium.state, other.state) > apart:
        raise NoEquilibriumError("the step leads to another branch")
    return there.parameter


def _adjacent(setting: Setting, lost: Feature, won: Feature) -> bool:
    """Whether a contact may roll on: to the corner at an edge's end, or back; to another of the object's corners."""
    outline = setting.outline
    if "corner" not in (lost[0], won[0]) and lost[2] != won[2]:
        return lost[1] == won[1]  # the object rolls along a face, from its corner on to its side or to the next corner
    if (lost[0] == "corner") == (won[0] == "corner") and lost[0] != "vertex":
        return False
    ends = [outline.ends(feature[1]) for feature in (lost, won)]
    if min(abs(a - b) for a in ends[0] for b in ends[1]) > _MEETING:
        return False
    return True


def _first(setting: Setting, path: Path, old: Along, new: Along, order: int) -> float:
    """Where the straight finger is touched first, by a contact that the new pose still has."""
    state, sites = old.equilibrium.state, new.equilibrium.state.sites

    def least(parameter: float, *, kept: bool) -> float:
        obstacle = setting.obstacle(path.frame(parameter))
        found = least_gaps(setting, obstacle, state, survey(setting, obstacle, state, brief=True))
        return min((g for g, at in found if any(_same(setting, at, site) for site in sites) == kept), default=np.inf)

    if np.isinf(least(new.parameter, kept=True)):
        raise NoEquilibriumError("the first contact has moved on within the step")
    where = _bracketed(lambda parameter: min(least(parameter, kept=True), 1.0), old.parameter, new.parameter)
    if least(where, kept=False) < -_GRAZED:
        raise NoEquilibriumError("the first contact has moved on within the step")
    points = replace(new, equilibrium=pointed(setting, new.equilibrium, order))
    return _joined(setting, path, Along(where, old.equilibrium), points, order)


def touched_at(setting: Setting, path: Path, old: Along, stop: float) -> float:
    """Where the straight finger is touched first."""
    state = old.equilibrium.state

    def least(parameter: float) -> float:
        obstacle = setting.obstacle(path.frame(parameter))
        found = least_gaps(setting, obstacle, state, survey(setting, obstacle, state, brief=True))
        return min((gap for gap, _ in found), default=1.0) + _GRAZED

    return _bracketed(least, old.parameter, stop)


def head_on(setting: Setting, path: Path, straight: Along, parameter: float) -> bool:
    """Whether the straight finger is met on its end face, where it is a strut."""
    state, obstacle = straight.equilibrium.state, setting.obstacle(path.frame(parameter))
    gaps = least_gaps(setting, obstacle, state, survey(setting, obstacle, state, brief=True))
    site = min(gaps, key=lambda gap: gap[0], default=(0.0, None))[1]
    return site is not None and site.kind == "tangent" and setting.outline.place(site.piece, np.zeros(1))[0] == "tip"


def _same(setting: Setting, touched: Site, site: Site) -> bool:
    """Whether a first contact, or the corner that it is at, is a contact of the next pose."""
    piece = touched.piece
    if touched.kind == "tangent":
        corner = setting.outline.corner_at(piece, touched.place[0])
        piece = piece if corner is None else corner
    return piece == site.piece and touched.vertex == site.vertex


def _changed(setting: Setting, path: Path, old: Along, new: Along, lost: Feature, won: Feature, order: int) -> float:
    """A contact that has a place on its piece tells by its reaching the end; a corner by its multiplier."""
    if lost[0] == won[0] == "vertex" and lost[1] == won[1]:
        return _rolled(setting, path, old, new, won, order)
    if "corner" not in (lost[0], won[0]) and lost[0] != won[0]:
        return _turned(setting, path, (old, new) if lost[0] == "vertex" else (new, old), (lost, won), order)
    if lost[0] != "corner":
        return _departed(setting, path, old, new, (lost, won), order)
    if won[0] != "corner" and not any(site.kind == "tail" for site in old.equilibrium.state.sites):
        return _departed(setting, path, new, old, (won, lost), order)
    return _released(setting, path, old, new, lost, order)


def _feature_name(setting: Setting, feature: Feature) -> str:
    kind, piece, vertex = feature
    on = setting.outline.place(piece, np.zeros(1))[0]
    if kind == "vertex":
        return f"the object's corner {vertex} on {on}"
    return f"corner of {on}" if kind == "corner" else on


def transition(setting: Setting, old: Equilibrium, new: Equilibrium) -> str:
    """What changes between two equilibria so near that they are one place of the motion."""
    before, after = features(old.state.sites), features(new.state.sites)
    gone, come = [f for f in before if f not in after], [f for f in after if f not in before]
    if len(gone) == len(come) == 1:
        return f"{_feature_name(setting, gone[0])} to {_feature_name(setting, come[0])}"
    return "several contacts at once"


def named(setting: Setting, site: Site) -> str:
    """What a contact is called in an event."""
    return _feature_name(setting, next(iter(features((replace(site, kind=_plain(site)),)))))


def _plain(site: Site) -> Kind:
    return "patch" if site.kind == "tail" else site.kind


def _pressing(setting: Setting, equilibrium: Equilibrium, i: int) -> float:
    """The multiplier of a contact: 0 where it is released, or was not yet touched."""
    sites = equilibrium.state.sites
    return float(equilibrium.state.multipliers[sum(site.multipliers for site in sites[:i])])


def _from_end(setting: Setting, equilibrium: Equilibrium, i: int, far: bool) -> tuple[float, float]:
    """How far a contact is from an end of its piece, the far one or the near one, and the rate of that."""
    sites = equilibrium.state.sites
    site, first = sites[i], sum(site.unknowns for site in sites[:i])
    rates = equilibrium.tangent()[2][first : first + site.unknown_places]
    if far:
        return setting.outline.pieces[site.piece].length - site.place[-1], -float(rates[-1])
    return site.place[0], float(rates[0])


class Branch:
    """The equilibria of one set of contacts near a known one, each reached from the nearest that is known."""

    def __init__(self, setting: Setting, path: Path, known: Along, order: int) -> None:
        self.setting, self.path, self.order = setting, path, order
        self.known = [known]

    def at(self, parameter: float) -> Equilibrium:
        """The equilibrium at a parameter.

        Raises
        ------
        NoEquilibriumError
            Where Newton does not reach it.
        """
        return self._reached(parameter, _HALVINGS)

    def _reached(self, parameter: float, halvings: int) -> Equilibrium:
        start = min(self.known, key=lambda at: abs(at.parameter - parameter))
        if start.parameter == parameter:
            return start.equilibrium
        guess = predicted(self.setting, start.equilibrium, parameter - start.parameter)
        expected = float(np.linalg.norm(guess.z - start.equilibrium.state.z))
        found = settle(self.setting, self.setting.obstacle(self.path.frame(parameter)), guess, self.order)
        if found.correction > _DEPARTS * expected + _APART:
            if not halvings:
                raise NoEquilibriumError("the step departs from its prediction")
            self._reached((start.parameter + parameter) / 2, halvings - 1)
            return self._reached(parameter, halvings - 1)
        self.known.append(Along(parameter, found))
        return found


def _released(setting: Setting, path: Path, known: Along, other: Along, feature: Feature, order: int) -> float:
    """Where a contact's multiplier vanishes on the branch of a known equilibrium, the contact held beyond.

    Raises
    ------
    NoEquilibriumError
        Where it does not, or where something else has touched before.
    """
    i = features(known.equilibrium.state.sites)[feature]
    branch = Branch(setting, path, replace(known, equilibrium=_pointed(setting, known.equilibrium, i, order)), order)
    where = _bracketed(lambda parameter: _pressing(setting, branch.at(parameter), i), known.parameter, other.parameter)
    there = branch.at(where)
    if not survey(setting, there.obstacle, there.state).clear:
        raise NoEquilibriumError("something else touches before")
    return _joined(setting, path, Along(where, there), other, order)


def _departed(
    setting: Setting, path: Path, known: Along, other: Along, pair: tuple[Feature, Feature], order: int
) -> float:
    """Where a contact's place reaches the end of its piece, on to another: steps that stop a little short of it."""
    i = features(known.equilibrium.state.sites)[pair[0]]
    if not known.equilibrium.state.sites[i].unknown_places:
        raise NoEquilibriumError("a contact without a place of its own ends")
    distant = setting.outline.ends(pair[0][1])[-1]
    far = min(abs(distant - end) for end in setting.outline.ends(pair[1][1])) < _MEETING
    branch, at, short = Branch(setting, path, known, order), known.parameter, _SHORT
    stop, way = other.parameter, other.parameter - known.parameter
    for _ in range(_STEPS):
        ahead, rate = _from_end(setting, branch.at(at), i, far)
        step = -ahead / rate * short if rate else way
        if abs(step) <= _SHARP * abs(way):
            return _joined(setting, path, Along(at, branch.at(at)), other, order)
        if not 0 <= (at + step - known.parameter) / way <= 1 + _OVERSHOT:
            step = stop + _OVERSHOT * way - at if step * way > 0 else known.parameter - at
            if abs(step) <= _SHARP * abs(way):
                raise NoEquilibriumError("a contact reaches the end of its face or edge beyond the step")
        try:
            branch.at(at + step)
            at, short = at + step, _SHORT
        except NoEquilibriumError:
            short /= 2
    raise NoEquilibriumError("a contact does not reach the end of its face or edge")


def _rolled(setting: Setting, path: Path, old: Along, new: Along, won: Feature, order: int) -> float:
    """Where the object's next corner comes down on a face."""
    branch, place = Branch(setting, path, old, order), new.equilibrium.state.sites[_number(new, won)].place[0]

    def height(parameter: float) -> float:
        there = branch.at(parameter)
        return vertex_height(setting, there.obstacle, there.state.axis, Site("vertex", won[1], (place,), won[2]))

    where = _bracketed(height, old.parameter, new.parameter)
    apart = max(_ROLLED, _ROLLS * distance(old.equilibrium.state, new.equilibrium.state))
    return _joined(setting, path, Along(where, branch.at(where)), new, order, apart)


def _turned(
    setting: Setting, path: Path, pair: tuple[Along, Along], contact: tuple[Feature, Feature], order: int
) -> float:
    """Where a face that turns about a corner of the object comes down on the side beside it."""
    at_corner, beside = pair
    corner, side = contact if contact[0][0] == "vertex" else contact[::-1]
    branch, i = Branch(setting, path, at_corner, order), _number(at_corner, corner)
    known = beside.equilibrium
    away = known.linear.points[_number(beside, side)].mean() - known.obstacle.corners[corner[2]]
    beginning = known.obstacle.corners[corner[2]] + away / abs(away) * _BESIDE
    slope = complex(known.obstacle.slope(np.array([beginning]))[1][0]) / np.exp(1j * known.obstacle.frame.angle)

    def turn(parameter: float) -> float:
        there = branch.at(parameter)
        pressing = complex(there.linear.forces[i].sum()) / np.exp(1j * there.obstacle.frame.angle)
        return float((slope.conjugate() * pressing).imag)

    where = _bracketed(turn, at_corner.parameter, beside.parameter)
    there, further = branch.at(where), where + _SHORTLY * (beside.parameter - where)
    other = Branch(setting, path, beside, order).at(further)
    if distance(there.state, other.state) > _ROLLED:
        raise NoEquilibriumError("the step leads to another branch")
    return where


def _number(known: Along, feature: Feature) -> int:
    return features(known.equilibrium.state.sites)[feature]


def pointed(setting: Setting, equilibrium: Equilibrium, order: int) -> Equilibrium:
    """All patches as points."""
    for i in range(len(equilibrium.state.sites)):
        equilibrium = _pointed(setting, equilibrium, i, order)
    return equilibrium


def _pointed(setting: Setting, equilibrium: Equilibrium, i: int, order: int) -> Equilibrium:
    """A patch shrinks to a point before it lets go: followed as a point, which may pull beyond the event."""
    site = equilibrium.state.sites[i]
    if site.kind != "patch":
        return equilibrium
    state = equilibrium.state
    first = sum(s.multipliers for s in state.sites[:i])
    sites = (*state.sites[:i], replace(site, kind="tangent", place=(site.middle,), modes=1), *state.sites[i + 1 :])
    multipliers = np.delete(state.multipliers, range(first + 1, first + site.multipliers))
    return settle(setting, equilibrium.obstacle, State(state.beam, state.z, sites, multipliers), order)


def _bracketed(value: Callable[[float], float], start: float, stop: float) -> float:
    """The root between two parameters.

    Raises
    ------
    NoEquilibriumError
        Where there is none.
    """
    first, last = value(start), value(stop)
    if abs(first) < _ROUND_OFF or abs(last) < _ROUND_OFF:
        return start if abs(first) < abs(last) else stop
    if first * last > 0:
        raise NoEquilibriumError("the step leads to another branch")
    return float(brentq(value, start, stop, xtol=_SHARP * abs(stop - start), rtol=1e-14))
