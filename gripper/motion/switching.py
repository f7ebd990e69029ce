"""At which place of a step contacts change their holds, and to which.

A step whose end contradicts a hold ends where that begins. Where contacts come and go on the same step, it ends there:
what slips beside a contact that comes, or lies down, may turn with it at once.
"""

from __future__ import annotations

from dataclasses import replace

from gripper.contact.features import features, gone_and_come, named
from gripper.contact.site import Site
from gripper.motion.branch import Along, branch_from, speed
from gripper.motion.events import Change, Kind, changes
from gripper.motion.holding import changing, excess
from gripper.motion.reheld import reheld
from gripper.motion.tracker import Tracker
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError
from gripper.statics.holds import (
    coefficient,
    grip_of,
    leaders,
    overdue,
    ratio_rate,
    regripped,
    rolling,
    slip_rates,
)
from gripper.statics.verified import Verified, verify

_SHORTEST = 1e-6  # of L: shorter steps are not cut for a hold
_REVERSED = 4  # times as long ones where slip only turns: it does so at once
_ASIDE = 0.3  # of it: how near to a change of contacts a step ends, before it and then behind it
_MOSTLY = 0.999  # of a step
_A_LITTLE = (2e-6, 1e-5, 1e-4)  # of L
_BRIEF = 5e-6  # of L: a contact that would stick on a shorter way only turns at once


class Switching(Tracker):
    """A tracker whose contacts change their holds."""

    heading = 0.0
    """Sign of the way along the parameter; 0 before the first step."""
    _rolls = False  # slip of the matter before and behind a contact that rolls has different senses
    _switched: frozenset[tuple[int, float, int]] | set[tuple[int, float, int]] = frozenset()

    def _overdue(self, equilibrium: Equilibrium) -> list[int]:
        """Contacts whose hold contradicts their motion or their force, unless they are known to roll on in between."""
        late = overdue(equilibrium, self.heading)
        if not self._rolls:
            return late
        rates = slip_rates(equilibrium)
        between = [i for i in leaders(equilibrium) if abs(rates[i]) <= rolling(equilibrium, i)]
        self._rolls = bool(between)
        return [i for i in late if i not in between or grip_of(equilibrium, i).hold == "stick"]

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

    def _tell_holds(self, before: tuple[Site, ...]) -> None:
        """Tell of the contacts that hold otherwise than before."""
        equilibrium = self.current.equilibrium
        olds = {feature: before[i].grip for feature, i in features(before).items()}
        for feature, i in features(equilibrium.state.sites).items():
            old, hold = olds.get(feature), grip_of(equilibrium, i).hold
            if old is not None and old.hold != hold and hold != "open":
                self._tell("slip" if hold == "slip" else "stick", equilibrium, i, "another contact comes")

    def _tell(self, kind: Kind, equilibrium: Equilibrium, i: int, why: str) -> None:
        if self.events:
            where = named(self.setting.outline, equilibrium.state.sites[i])
            self.changes.append(Change(self.parameter, kind, f"{where}: {why}" if why else where))

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
