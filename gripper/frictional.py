"""Following an equilibrium with friction: contacts slip and stick, and remember.

Every step is first taken with the holds that the contacts have. Where at its end a contact slips against its sense,
or sticks with more than mu, the step ends where that begins: the slip's rate, or mu less the ratio, has its root
there. The hold changes at that point of the motion, so that no answer depends on how far apart the poses are.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from gripper.answer import Answer
from gripper.branch import Along, Branch, pointed
from gripper.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.events import Change, touched_at
from gripper.features import Feature, features, gone_and_come, named
from gripper.grip import dressed
from gripper.holds import coefficient, grip_of, leaders, margin, overdue, ratio_rate, regripped, slip_rates, tangent
from gripper.locking import LockedError, free_slip, limiting_ratio
from gripper.peaks import Peak
from gripper.tracker import Tracker
from gripper.verified import Verified, untouched, verify
from gripper.work import BESIDE, STILL, Balance, Pace, dips, drawn, pace, speed

_NUDGE = 1e-5  # of L: how far beyond the first touch the first hold is decided
_SHARP = 1e-10  # of the step: where a hold changes is located to
_AT_ONCE = 1e-9  # of its value at the step's end: a margin this small is none
_FINE = 1e-2  # of L: shorter steps are not cut for their balance
_ASIDE = 2e-4  # of L
_CHANGING = 0.01  # of L: the longest step in which a patch comes or goes, or that ends free of the object
_BALANCED = 5e-5  # of the energies of a step
_BEYOND = 1.5  # of the way to where a contact starts to slip, by the tangent
_LEAST = 1e-4  # of a step
_SHORTEST = 1e-6  # of L: shorter steps are not cut for a hold
_MOST = 8  # changes of hold at one place, snaps on the way to one pose
_ALMOST = 1.05  # a contact that sticks this near to locking does not get away from it

Part = tuple[float, Pace, float, Pace]
_REST = Pace(np.zeros(2), np.zeros(2), np.zeros((0, 2)))


class FrictionTracker(Tracker):
    """A tracker whose contacts slip and stick."""

    heading = 0.0
    """Sign of the way along the parameter; 0 before the first step."""
    balance = Balance()
    """Work put in and energy lost so far."""
    peaks: tuple[Peak, ...] = ()
    """The largest force of the drive, one a leg of the motion."""
    _paced: tuple[float, Verified | None, Pace | None] = (0.0, None, None)
    _snaps = 0
    _switched: frozenset[tuple[int, float, int]] | set[tuple[int, float, int]] = frozenset()

    def begin(self, heading: float) -> None:
        """A motion that starts in contact: the contacts hold as if it had come that way."""
        self.heading = heading
        law = self.setting.friction
        state = self.current.equilibrium.state
        if law is None or not state.sites:
            return
        dressing = replace(state, sites=dressed(law, (), state.sites))
        self.current = self._decided(self._at(self.parameter, dressing), self.parameter)

    def _step(self, following: float) -> None:
        heading = float(np.sign(following - self.parameter))
        if not self.sites:
            self._meet(following)
            self.heading = heading
            return
        if self._travel(self.parameter, following) < STILL:
            self.parameter, self.current = following, self._at(following, self.current.equilibrium.state)
            return
        if heading != self.heading:
            self._turn(heading)
        self._check_locked(self.current.equilibrium)
        following = self._within_stick(following)
        found = self._followed(following)
        found = self._decided(found, following)
        late = overdue(found.equilibrium, heading)
        if late:
            self._change_hold(found, following, late)
            return
        stop = pace(self.setting, self.path, Along(following, found.equilibrium), heading)
        if self._coarse(found, stop, following):
            self._step((self.parameter + following) / 2)
            return
        self._accept(following, found, stop)

    def _check_locked(self, equilibrium: Equilibrium, factor: float = 1.0) -> None:
        """Whether a contact that sticks could not slip on with any force.

        Raises
        ------
        LockedError
            Where friction holds the finger.
        """
        for i in leaders(equilibrium):
            if grip_of(equilibrium, i).hold == "slip":
                continue
            side = -self.heading * np.sign(free_slip(self.setting, equilibrium, i))
            limit, mu = limiting_ratio(self.setting, equilibrium, i, side), coefficient(equilibrium, i)
            if limit <= factor * mu:
                raise LockedError(limit, mu)

    def _within_stick(self, following: float) -> float:
        """No further than a little beyond where a contact that sticks reaches mu: far beyond, its ratio runs away."""
        equilibrium, way = self.current.equilibrium, abs(following - self.parameter)
        reach = way
        for i in leaders(equilibrium):
            if grip_of(equilibrium, i).hold == "stick":
                rate = ratio_rate(equilibrium, i) * self.heading
                room = coefficient(equilibrium, i) - float(np.sign(rate)) * grip_of(equilibrium, i).ratio
                reach = min(reach, max(_BEYOND * room / abs(rate), _LEAST * way) if rate else reach)
        return following if reach >= way else self.parameter + self.heading * reach

    def _coarse(self, found: Verified, stop: Pace, following: float) -> bool:
        """Whether a hold may change and change back within the step, or its work does not balance."""
        old, new, way = self.current.equilibrium, found.equilibrium, following - self.parameter
        travel = self._travel(self.parameter, following)
        if holds(old) != holds(new):
            spread = any(site.kind in ("patch", "tail") for site in (*old.state.sites, *new.state.sites))
            return travel > (_CHANGING if spread or not new.state.sites else 3 * _CHANGING)
        if travel < _FINE:
            return False
        start = self._pace()
        step = Balance().plus(start, stop, way)
        stored = new.state.energy - old.state.energy
        if abs(step.work - step.loss - stored) > _BALANCED * (abs(stored) + step.loss):
            return True
        return dips(start, stop, way)

    def _pace(self) -> Pace:
        """The pace of the current equilibrium, reckoned once."""
        parameter, found, known = self._paced
        if known is None or found is not self.current or parameter != self.parameter:
            known = pace(self.setting, self.path, Along(self.parameter, self.current.equilibrium), self.heading)
            self._paced = self.parameter, self.current, known
        return known

    def _accept(self, following: float, found: Verified, stop: Pace | None = None) -> None:
        """Go on, and book work and dissipation; the pace at the end where it is known."""
        start = self.parameter
        touching = self.sites
        before = self._pace() if touching else _REST
        known, old = len(self.changes), self.current
        super()._accept(following, found)
        if stop is not None:
            self._paced = following, found, stop
        after = self._pace() if self.sites else _REST
        broken = [change.parameter for change in self.changes[known:] if change.kind in ("touch", "change", "release")]
        parts = [(start, before, following, after)]
        if broken:
            ends = Along(start, old.equilibrium), Along(following, found.equilibrium)
            parts = self._broken(*ends, before, after, broken)
        for begin, first, end, last in parts:
            self.balance = self.balance.plus(first, last, end - begin)
            near = Along(start, old.equilibrium) if begin == start else Along(following, found.equilibrium)
            self._note(Peak.of(begin, first, end, last, near))

    def _note(self, peak: Peak) -> None:
        """Keep the largest force of each leg of the motion."""
        if not peak.heading:
            return
        if not self.peaks or peak.heading != self.peaks[-1].heading:
            self.peaks = (*self.peaks, peak)
        elif peak.force > self.peaks[-1].force:
            self.peaks = (*self.peaks[:-1], peak)

    def _broken(self, old: Along, new: Along, before: Pace, after: Pace, broken: list[float]) -> list[Part]:
        """The step on both sides of a change of the contacts, at which the rates jump."""
        first = self._side(broken[0], old, before)
        last = self._side(broken[-1], new, after)
        return [(old.parameter, before, broken[0], first), (broken[-1], last, new.parameter, after)]

    def _side(self, at: float, near: Along, known: Pace) -> Pace:
        """The pace on one side of a change, on the branch of the step's end there.

        It is drawn from a little aside of the change, where no segment of the finger is all but gone.
        """
        fast, way = speed(near.equilibrium), near.parameter - at
        if abs(way) * fast <= max(BESIDE) * _ASIDE:
            return known.carried(-way)
        part = float(np.sign(way)) * _ASIDE / fast
        try:
            near = replace(near, equilibrium=pointed(self.setting, near.equilibrium, self.order))
            branch = Branch(self.setting, self.path, near, self.order)
            found = {parts: branch.at(at + parts * part) for parts in BESIDE[::-1]}
            return drawn([found[parts] for parts in BESIDE], part, self.heading)
        except NoEquilibriumError:
            return known.carried(-way)

    def _meet(self, following: float) -> None:
        """The finger is free: go on to the first touch, and decide there how it holds."""
        free = self._free(following)
        if untouched(self.setting, free):
            self.parameter, self.current = following, free
            return
        start, here = self.parameter, Along(self.parameter, self.current.equilibrium)
        touch = touched_at(self.setting, self.path, here, following)
        rest = self._travel(touch, following)
        near = touch + (following - touch) * _NUDGE / rest if rest > _NUDGE else following
        self.heading = float(np.sign(following - start))
        before = 2 * touch - near
        if (before - start) * self.heading > 0:  # so that the touch is located on a short step
            self.parameter, self.current = before, self._free(before)
        found = None
        try:
            found = self._decided(self._touched(near), near)
        except NoEquilibriumError:
            if near == following:
                raise
        if found is None or not found.equilibrium.state.sites:
            near = following
            found = self._decided(self._touched(near), near)
        self._accept(near, found)

    def _turn(self, heading: float) -> None:
        """Where the motion turns, slip that would go against its sense stops: the contact sticks."""
        self.heading = heading
        equilibrium = self.current.equilibrium
        rates = slip_rates(equilibrium)
        for i in leaders(equilibrium):
            grip = grip_of(equilibrium, i)
            if grip.hold == "slip" and rates[i] * heading * grip.sense <= 0:
                equilibrium = regripped(self.setting, equilibrium, i, 0, self.order)
                self._tell("stick", equilibrium, i, "the motion turns")
        self.current = replace(self.current, equilibrium=equilibrium)

    def _snap(self, following: float, error: NoEquilibriumError) -> None:
        """Beyond the last equilibrium: the finger is all but locked, or it snaps, and its contacts slip anew."""
        equilibrium = self.current.equilibrium
        self._check_locked(equilibrium, _ALMOST)
        self._snaps += 1
        if self._snaps > _MOST:
            raise NoEquilibriumError(f"the finger snaps again and again: {error}") from error
        super()._snap(following, error)
        if self.sites:
            self.current = self._decided(self.current, self.parameter)

    def advance(self, target: float) -> Answer:
        """Follow the path to a value of its parameter.

        Raises
        ------
        NoEquilibriumError
            Where no equilibrium could be followed that far; the tracker stays at the last one it found.
        LockedError
            Where friction holds the finger for any force.
        """
        self._snaps = 0
        return super().advance(target)

    def _tell(self, kind: str, equilibrium: Equilibrium, i: int, why: str) -> None:
        if self.events:
            where = named(self.setting.outline, equilibrium.state.sites[i])
            self.changes.append(Change(self.parameter, kind, f"{where}: {why}" if why else where))  # type: ignore[arg-type]

    # new contacts

    def _decided(self, found: Verified, at: float) -> Verified:
        """Contacts that came without a hold get the one that is consistent."""
        for _ in range(_MOST):
            equilibrium = found.equilibrium
            undecided = [i for i in leaders(equilibrium) if grip_of(equilibrium, i).hold == "open"]
            if not undecided:
                return found
            found = verify(self.setting, self._first_hold(equilibrium, undecided[0]))
        raise NoEquilibriumError("the holds of the contacts contradict each other")

    def _first_hold(self, equilibrium: Equilibrium, i: int) -> Equilibrium:
        """Slip, if it goes on in its sense, the likelier sense first; else stick, if its ratio stays within mu."""
        if speed(equilibrium) < STILL:
            return regripped(self.setting, equilibrium, i, 0, self.order)
        likely = 1 if slip_rates(equilibrium)[i] * self.heading >= 0 else -1
        options: list[Callable[[], Equilibrium | None]] = [
            functools.partial(self._slipping, equilibrium, i, sense) for sense in (likely, -likely)
        ]
        options.append(functools.partial(self._sticking, equilibrium, i))
        for option in options:
            found = option()
            if found is not None:
                return found
        self._check_locked(equilibrium)
        raise NoEquilibriumError("no hold of a new contact is consistent with Coulomb's law")

    def _slipping(self, equilibrium: Equilibrium, i: int, sense: int) -> Equilibrium | None:
        try:
            found = regripped(self.setting, equilibrium, i, sense, self.order)
            verify(self.setting, found)
            return found if slip_rates(found)[i] * self.heading * sense > 0 else None
        except NoEquilibriumError:
            return None

    def _sticking(self, equilibrium: Equilibrium, i: int) -> Equilibrium | None:
        """Stick from the first touch on: the ratio that it tends to."""
        try:
            found = regripped(self.setting, equilibrium, i, 0, self.order)
            row = sum(site.multipliers for site in found.state.sites[:i])
            rate = float(tangent(found)[1][row]) / float(found.state.multipliers[row])
            return found if abs(ratio_rate(found, i)) <= coefficient(found, i) * abs(rate) else None
        except NoEquilibriumError:
            return None

    # changes of hold

    def _change_hold(self, found: Verified, following: float, late: list[int]) -> None:
        """Go to where the first contact changes its hold, and change it."""
        old = self.current.equilibrium
        if any(gone_and_come(old.state.sites, found.equilibrium.state.sites)):
            self._halve(found, following)
            return
        if _kinds(old) == _kinds(found.equilibrium):
            branch = Branch(self.setting, self.path, Along(self.parameter, old), self.order)
            branch.known.append(Along(following, found.equilibrium))
        else:
            branch = Branch(self.setting, self.path, Along(following, found.equilibrium), self.order)
        places = [self._place(branch, found.equilibrium, i, following) for i in late]
        first = min(range(len(late)), key=lambda k: abs(places[k] - self.parameter))
        where, i = places[first], late[first]
        if where == self.parameter:
            self._switch(i, self._excess(found.equilibrium, i))
            return
        before = verify(self.setting, branch.at(where))
        self._accept(where, before)
        self._switch(i, self._excess(found.equilibrium, i))

    def _halve(self, found: Verified, following: float) -> None:
        """Contacts change in the same step: take half of it."""
        if self._travel(self.parameter, following) < _SHORTEST:
            self._accept(following, found)
            for i in overdue(found.equilibrium, self.heading):
                self._switch(i, self._excess(found.equilibrium, i))
            return
        self._step((self.parameter + following) / 2)

    @staticmethod
    def _excess(equilibrium: Equilibrium, i: int) -> float:
        """On which side a contact that sticks leaves mu."""
        return float(np.sign(grip_of(equilibrium, i).ratio))

    def _place(self, branch: Branch, end: Equilibrium, i: int, following: float) -> float:
        """Where on the step a contact changes its hold."""
        bound = self._excess(end, i)

        def left(parameter: float) -> float:
            return margin(branch.at(parameter), i, self.heading, bound)

        if left(self.parameter) <= _AT_ONCE * abs(left(following)):
            return self.parameter
        sharp = _SHARP * abs(following - self.parameter)
        return float(brentq(left, self.parameter, following, xtol=sharp, rtol=1e-14))

    def _switch(self, i: int, bound: float) -> None:
        """Change the hold of a contact here: slip to stick, or stick to slip.

        Where a contact would stick only with more than mu at once, it slips the other way.

        Raises
        ------
        NoEquilibriumError
            Where no hold is consistent.
        """
        equilibrium = self.current.equilibrium
        grip = grip_of(equilibrium, i)
        sense = 0 if grip.hold == "slip" else -int(bound)
        why = ""
        if sense and (i, self.parameter, sense) in self._switched:
            sense, why = -sense, "the other way"
        if (i, self.parameter, sense) in self._switched:
            raise NoEquilibriumError("no hold of a contact is consistent with Coulomb's law")
        self._switched = {at for at in self._switched if at[1] == self.parameter}
        self._switched |= {(i, self.parameter, grip.sense), (i, self.parameter, sense)}
        found = regripped(self.setting, equilibrium, i, sense, self.order)
        self.current = verify(self.setting, found)
        self._tell("slip" if sense else "stick", found, i, why)


def holds(equilibrium: Equilibrium) -> list[tuple[Feature, str | None]]:
    """What touches and how it holds."""
    sites = equilibrium.state.sites
    return [(feature, getattr(sites[i].grip, "hold", None)) for feature, i in features(sites).items()]


def _kinds(equilibrium: Equilibrium) -> list[str]:
    return [site.kind for site in equilibrium.state.sites]


def tracker_for(setting: Setting) -> type[Tracker]:
    """The tracker that a setting needs: with friction that the motion decides, one that slips and sticks."""
    decides = setting.friction is not None and not setting.friction.tipward
    return FrictionTracker if decides else Tracker
