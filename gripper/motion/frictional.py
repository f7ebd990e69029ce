"""Following an equilibrium with friction: contacts slip and stick, and remember.

Every step is first taken with the holds that the contacts have. Where at its end a contact slips against its sense,
or sticks with more than mu, the step ends where that begins: the slip's rate, or mu less the ratio, has its root
there. The hold changes at that point of the motion, so that no answer depends on how far apart the poses are.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from gripper.contact.features import Feature, features, gone_and_come, named
from gripper.contact.site import Site
from gripper.motion.branch import STILL, Along, branch_from, speed
from gripper.motion.events import Change, Kind, changes, touched_at
from gripper.motion.holding import changing, decided, excess
from gripper.motion.ledger import BALANCED, Ledger
from gripper.motion.locking import check_locked
from gripper.motion.others import other_solutions
from gripper.motion.reheld import reheld
from gripper.motion.touching import NUDGE
from gripper.motion.tracker import Tracker
from gripper.motion.work import dips
from gripper.result import PoseResult
from gripper.results.loop import Loop
from gripper.statics.answer import Answer
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, State
from gripper.statics.gathered import gathered
from gripper.statics.holds import (
    coefficient,
    grip_of,
    leaders,
    overdue,
    ratio_rate,
    regripped,
    rolling,
    slip_rates,
    tangent,
)
from gripper.statics.verified import Verified, untouched, verify

_FINE = 1e-2  # of L: shorter steps are not cut for holds that may change and change back
_FINEST = 1e-3  # of L: shorter ones are not cut for their balance
_CHANGING = 0.01  # of L: the longest step in which a patch comes or goes, or that ends free of the object
_BEYOND = 1.5  # of the way to where a contact starts to slip, by the tangent
_LEAST, _JUST = 1e-8, 1e-4  # of a step: the shortest, and where a contact has only just begun to stick
_AT_MU = 1e-6  # relative: the ratio of one that has
_SOON = 4e-6  # of L: a contact that sticks from its touch on is found this soon behind it
_SHORTEST = 1e-6  # of L: shorter steps are not cut for a hold
_A_LITTLE = (2e-6, 1e-5, 1e-4)  # of L
_REVERSED = 4  # times as long ones where slip only turns: it does so at once
_ASIDE = 0.3  # of it: how near to a change of contacts a step ends, before it and then behind it
_MOSTLY = 0.999  # of a step
_BRIEF = 5e-6  # of L: a contact that would stick on a shorter way only turns at once
_MOST = 8  # snaps on the way to one pose
_ALMOST = 1.05  # a contact that sticks this near to locking does not get away from it


class FrictionTracker(Tracker):
    """A tracker whose contacts slip and stick."""

    heading = 0.0
    """Sign of the way along the parameter; 0 before the first step."""
    _snaps = 0
    _rolls = False  # slip of the matter before and behind a contact that rolls has different senses
    _switched: frozenset[tuple[int, float, int]] | set[tuple[int, float, int]] = frozenset()

    @functools.cached_property
    def ledger(self) -> Ledger:
        """Work put in and energy lost so far, and the largest forces."""
        return Ledger(self.setting, self.path)

    def begin(self, heading: float) -> None:
        """A motion that starts in contact: the contacts hold as if it had come that way."""
        self.heading = heading
        law = self.setting.friction
        state = self.current.equilibrium.state
        if law is None or not state.sites:
            return
        dressing = replace(state, sites=law.dressed((), state.sites))
        self.current = self._decided(self._at(self.parameter, dressing))

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
        check_locked(self.setting, self.current.equilibrium, heading)
        following = self._within_stick(following)
        found = self._followed(following)
        found = self._decided(found, following)
        late = self._overdue(found.equilibrium)
        if late:
            self._change_hold(found, following, late)
            return
        if self._coarse(found, following):
            self._step((self.parameter + following) / 2)
            return
        self._accept(following, found)

    def _overdue(self, equilibrium: Equilibrium) -> list[int]:
        """Contacts whose hold contradicts their motion or their force, unless they are known to roll on in between."""
        late = overdue(equilibrium, self.heading)
        if not self._rolls:
            return late
        rates = slip_rates(equilibrium)
        between = [i for i in leaders(equilibrium) if abs(rates[i]) <= rolling(equilibrium, i)]
        self._rolls = bool(between)
        return [i for i in late if i not in between or grip_of(equilibrium, i).hold == "stick"]

    def _decided(self, found: Verified, following: float | None = None) -> Verified:
        """Contacts that came without a hold, on the way to where they are found, get the one that is consistent."""
        soon = following is None or self._travel(self.parameter, following) < _SOON
        return decided(self.setting, found, self.heading, self.order, soon=soon)

    def _completed(self, parameter: float, middle: Verified) -> Verified | None:
        try:
            middle = self._decided(middle, parameter)
        except NoEquilibriumError:
            return None
        late = self._overdue(middle.equilibrium)
        return None if late or self._coarse(middle, parameter) else middle

    def _within_stick(self, following: float) -> float:
        """No further than a little beyond where a contact that sticks reaches mu, or lets go: beyond it runs away."""
        equilibrium, way = self.current.equilibrium, abs(following - self.parameter)
        stuck = [i for i in leaders(equilibrium) if grip_of(equilibrium, i).hold == "stick"]
        if not stuck:
            return following
        reach = way
        for i in stuck:
            rate = ratio_rate(equilibrium, i) * self.heading
            room = coefficient(equilibrium, i) - float(np.sign(rate)) * grip_of(equilibrium, i).ratio
            least = _LEAST if room > _AT_MU * coefficient(equilibrium, i) else _JUST
            reach = min(reach, max(_BEYOND * room / abs(rate), least * way) if rate else reach)
        if len(equilibrium.state.sites) > 1:  # those that stick on one edge press on each other as fast
            first = np.cumsum([0, *(site.multipliers for site in equilibrium.state.sites[:-1])])
            loads, rates = equilibrium.state.multipliers[first], tangent(equilibrium)[1][first] * self.heading
            falling = rates < 0
            reach = min([reach, *np.maximum(-_BEYOND * loads[falling] / rates[falling], _LEAST * reach)])
        return following if reach >= way else self.parameter + self.heading * reach

    def _found(self, following: float, guess: State) -> Verified:
        """Where contacts stick, those that would have to pull let go: without friction others might."""
        keep = [bool(load.max() > 0) for load in guess.loads]
        if any(site.grip and site.grip.hold == "stick" for site in guess.sites) and any(keep) and not all(keep):
            try:
                return self._at(following, guess.keeping(keep))
            except NoEquilibriumError:
                pass  # the set is another one
        try:
            return super()._found(following, guess)
        except NoEquilibriumError:
            obstacle = self.setting.obstacle(self.path.frame(following))
            return gathered(self.setting, obstacle, self.current.equilibrium.state, guess, self.order)

    def _coarse(self, found: Verified, following: float) -> bool:
        """Whether a hold may change and change back within the step."""
        old, new = self.current.equilibrium, found.equilibrium
        travel = self._travel(self.parameter, following)
        if holds(old) != holds(new):
            spread = any(site.spreads for site in (*old.state.sites, *new.state.sites))
            return travel > (_CHANGING if spread or not new.state.sites else 3 * _CHANGING)
        if travel < _FINE:
            return False
        start = self.ledger.pace(Along(self.parameter, old), self.heading)
        stop = self.ledger.pace(Along(following, new), self.heading)
        return dips(start, stop, following - self.parameter)

    def _book(self, before: Along, after: Along, broken: list[float]) -> None:
        """Book work and dissipation of a step, unless it is too long for that.

        Raises
        ------
        NoEquilibriumError
            Where the books do not balance, on a step that is worth cutting.
        """
        entry = self.ledger.drawn_up(before, after, broken, self.heading, self.order)
        if entry.off > BALANCED and self._travel(before.parameter, after.parameter) > _FINEST:
            raise NoEquilibriumError("the work of a step is neither stored nor lost")
        self.ledger.enter(entry)
        super()._book(before, after, broken)

    def _meet(self, following: float) -> None:
        """The finger is free: go on to the first touch, and decide there how it holds."""
        free = self._free(following, self.current.equilibrium.state)
        start, here = self.parameter, Along(self.parameter, self.current.equilibrium)
        touch = None if untouched(self.setting, free) else touched_at(self.setting, self.path, here, following)
        if touch is None:
            if not free.survey.clear:
                raise NoEquilibriumError("what is touched first is not found")
            self.parameter, self.current = following, free
            return
        rest = self._travel(touch, following)
        near = touch + (following - touch) * NUDGE / rest if rest > NUDGE else following
        self.heading = float(np.sign(following - start))
        before = 2 * touch - near
        if (before - start) * self.heading > 0:  # so that the touch is located on a short step
            shortly = self._free(before, self.current.equilibrium.state)
            if not shortly.survey.clear:
                raise NoEquilibriumError("what is touched first is not found")
            self.parameter, self.current = before, shortly
        found = None
        try:
            found = self._decided(self._touched(near))
        except NoEquilibriumError:
            if near == following:
                raise
        if found is None or not found.equilibrium.state.sites:
            near = following
            found = self._decided(self._touched(near))
        self._accept(near, found)

    def _turn(self, heading: float) -> None:
        """Where the motion turns, slip that would go against its sense stops: the contact sticks."""
        self.heading = heading
        equilibrium = self.current.equilibrium
        rates = slip_rates(equilibrium)
        for i in leaders(equilibrium):
            grip = grip_of(equilibrium, i)  # which may stick already, together with another one
            if grip.hold == "slip" and rates[i] * heading * grip.sense <= 0:
                equilibrium = regripped(self.setting, equilibrium, i, 0, self.order)
                self._tell("stick", equilibrium, i, "the motion turns")
                if self._sticks_shortly(equilibrium, i):
                    equilibrium = regripped(self.setting, equilibrium, i, -grip.sense, self.order)
                    self._tell("slip", equilibrium, i, "")
        self.current = replace(self.current, equilibrium=equilibrium)

    def _snap(self, following: float, error: NoEquilibriumError) -> None:
        """Beyond the last equilibrium: the finger is all but locked, or it snaps, and its contacts slip anew."""
        equilibrium = self.current.equilibrium
        check_locked(self.setting, equilibrium, self.heading, _ALMOST)
        self._snaps += 1
        if self._snaps > _MOST:
            raise NoEquilibriumError(f"the finger snaps again and again: {error}") from error
        if self.sites and self._reheld(following):
            return
        before, start = Along(self.parameter, equilibrium), self.current
        super()._snap(following, error)
        try:
            if self.sites:
                self.current = self._decided(self.current)
            self.ledger.fall(before, Along(self.parameter, self.current.equilibrium), self.heading)
        except NoEquilibriumError:
            self.parameter, self.current = before.parameter, start
            self.changes.pop()
            raise

    def _reheld(self, following: float) -> bool:
        """Go on towards a parameter with other holds of the contacts, or one that comes, where these lead on."""
        before = self.current.equilibrium.state.sites
        for room in _A_LITTLE:
            near = self.stride.within(self.parameter, following, room, self.current)
            obstacle = self.setting.obstacle(self.path.frame(near))
            found = reheld(self.setting, obstacle, self.current.equilibrium, self.heading, self.order)
            try:
                if found is not None:
                    self._accept(near, found)
                    self._tell_holds(before)
                    return True
            except NoEquilibriumError:
                continue  # these are of another branch
        return False

    def _tell_holds(self, before: tuple[Site, ...]) -> None:
        """Tell of the contacts that hold otherwise than before."""
        equilibrium = self.current.equilibrium
        olds = {feature: before[i].grip for feature, i in features(before).items()}
        for feature, i in features(equilibrium.state.sites).items():
            old, hold = olds.get(feature), grip_of(equilibrium, i).hold
            if old is not None and old.hold != hold and hold != "open":
                self._tell("slip" if hold == "slip" else "stick", equilibrium, i, "another contact comes")

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

    # what is told of it

    def account(self, pose: PoseResult) -> PoseResult:
        """The pose with work and dissipation since the motion began, and with the other solutions that there are."""
        if pose.status not in ("contact", "free"):
            return pose
        unit, balance = self.setting.sections.energy_scale, self.ledger.balance
        others = other_solutions(self.setting, self.current.equilibrium, self.heading)
        checks = pose.checks.but(other_solutions=others)
        return pose.but(work=balance.work * unit, dissipation=balance.loss * unit, checks=checks)

    def loop(self) -> tuple[Loop | None, list[Equilibrium | None]]:
        """The loop so far, and the equilibria at its peaks, where they are known; None without contact."""
        unit, balance = self.setting.sections.energy_scale, self.ledger.balance
        tops = [peak.located(self.setting, self.path, self.order) for peak in self.ledger.peaks[:2]]
        if not tops:
            return None, []
        there, back = tops[0], tops[1] if len(tops) > 1 else None
        loop = Loop(
            peak_insertion_force=there.force * unit,
            peak_insertion_parameter=there.parameter,
            peak_retention_force=back.force * unit if back else None,
            peak_retention_parameter=back.parameter if back else None,
            ratio=back.force / there.force if back and there.force > 0 else None,
            work_in=balance.put_in * unit,
            work_out=balance.given_back * unit,
            dissipation=balance.loss * unit,
        )
        return loop, [top.equilibrium for top in tops]

    def _tell(self, kind: Kind, equilibrium: Equilibrium, i: int, why: str) -> None:
        if self.events:
            where = named(self.setting.outline, equilibrium.state.sites[i])
            self.changes.append(Change(self.parameter, kind, f"{where}: {why}" if why else where))

    # changes of hold

    def _change_hold(self, found: Verified, following: float, late: list[int]) -> None:
        """Go to where the first contact changes its hold, and change it."""
        old = self.current.equilibrium
        if any(gone_and_come(old.state.sites, found.equilibrium.state.sites)):
            self._change_both(found, following)
            return
        ends = Along(self.parameter, old), Along(following, found.equilibrium)
        where, i, branch = changing(self.setting, self.path, *ends, late, self.heading, self.order)
        if where == self.parameter:
            self._switch(i, excess(found.equilibrium, i))
            return
        before = verify(self.setting, branch.at(where))
        self._accept(where, before)
        self._switch(i, excess(found.equilibrium, i))

    def _change_both(self, found: Verified, following: float) -> None:
        """Contacts change in the same step: go to where they do, and change the hold there; else take half of it."""
        travel = self._travel(self.parameter, following)
        late = [grip_of(found.equilibrium, i).hold for i in self._overdue(found.equilibrium)]
        if travel < _SHORTEST * (1 if "stick" in late else _REVERSED):
            self._accept_late(following, found)
            return
        half, aside = (self.parameter + following) / 2, (following - self.parameter) * _ASIDE * _SHORTEST / travel
        new = Along(following, found.equilibrium)
        try:
            changed = changes(self.setting, self.path, self.here, new, self.order)
            where = min((change.parameter for change in changed), key=lambda p: abs(p - self.parameter))
            ahead = (where - self.parameter) / aside
            if ahead > 2:
                near, reached = self.parameter + (ahead - 1) * aside, None
            else:  # it may have been kept a hair beyond
                near = self.parameter + max(ahead + 1, 1.0) * aside
                reached = verify(self.setting, branch_from(self.setting, self.path, new, self.order).at(near))
        except NoEquilibriumError:
            near, reached = half, None
        if reached is None:
            part = (near - self.parameter) / (following - self.parameter)
            self._step(near if part < _MOSTLY else half)
        else:
            self._accept_late(near, reached)

    def _accept_late(self, following: float, found: Verified) -> None:
        """Go on, and change the holds that are overdue there."""
        self._accept(following, found)
        for i in self._overdue(found.equilibrium):
            self._switch(i, excess(found.equilibrium, i))

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
            if grip.hold == "slip" and abs(slip_rates(equilibrium)[i]) <= rolling(equilibrium, i):
                self._rolls = True
                return
            raise NoEquilibriumError("no hold of a contact is consistent with Coulomb's law")
        self._switched = {at for at in self._switched if at[1] == self.parameter}
        self._switched |= {(i, self.parameter, grip.sense), (i, self.parameter, sense)}
        found = regripped(self.setting, equilibrium, i, sense, self.order)
        if not sense and self._sticks_shortly(found, i):
            sense, why = -grip.sense, "the other way"
            found = regripped(self.setting, equilibrium, i, sense, self.order)
        self.current = verify(self.setting, found)
        self._tell("slip" if sense else "stick", found, i, why)

    def _sticks_shortly(self, found: Equilibrium, i: int) -> bool:
        """Whether a contact that begins to stick slips the other way before the least step is over."""
        if len(leaders(found)) > 1 or not all(site.on_face for site in found.state.sites):
            return False  # one may let go before
        rate, ratio = ratio_rate(found, i) * self.heading, grip_of(found, i).ratio
        room = coefficient(found, i) + abs(ratio)
        return rate * ratio < 0 and room * speed(found) < _BRIEF * abs(rate)


def holds(equilibrium: Equilibrium) -> list[tuple[Feature, str | None]]:
    """What touches and how it holds."""
    sites = equilibrium.state.sites
    return [(feature, getattr(sites[i].grip, "hold", None)) for feature, i in features(sites).items()]
