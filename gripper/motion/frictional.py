"""Following an equilibrium with friction: contacts slip and stick, and remember.

Every step is first taken with the holds that the contacts have. Where at its end a contact slips against its sense,
or sticks with more than mu, the step ends where that begins: the slip's rate, or mu less the ratio, has its root
there. The hold changes at that point of the motion, so that no answer depends on how far apart the poses are.
"""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from gripper.contact.features import Feature, features
from gripper.motion.branch import STILL, Along
from gripper.motion.events import touched_at
from gripper.motion.holding import decided
from gripper.motion.ledger import BALANCED, Ledger
from gripper.motion.locking import check_locked
from gripper.motion.others import other_solutions
from gripper.motion.switching import Switching
from gripper.motion.touching import NUDGE
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
    ratio_rate,
    tangent,
)
from gripper.statics.verified import Verified, untouched

_FINE = 1e-2  # of L: shorter steps are not cut for holds that may change and change back
_FINEST = 1e-3  # of L: shorter ones are not cut for their balance
_CHANGING = 0.01  # of L: the longest step in which a patch comes or goes, or that ends free of the object
_BEYOND = 1.5  # of the way to where a contact starts to slip, by the tangent
_LEAST, _JUST = 1e-8, 1e-4  # of a step: the shortest, and where a contact has only just begun to stick
_AT_MU = 1e-6  # relative: the ratio of one that has
_SOON = 4e-6  # of L: a contact that sticks from its touch on is found this soon behind it
_MOST = 8  # snaps on the way to one pose
_ALMOST = 1.05  # a contact that sticks this near to locking does not get away from it


class FrictionTracker(Switching):
    """A tracker whose contacts slip and stick."""

    _snaps = 0

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

    def loop(self) -> tuple[Loop | None, list[Equilibrium | None]]:
        """The loop so far, and the equilibria at its peaks, where they are known; None without contact."""
        return self.ledger.loop(self.order)

    def account(self, pose: PoseResult) -> PoseResult:
        """The pose with work and dissipation since the motion began, and with the other solutions that there are."""
        if pose.status not in ("contact", "free"):
            return pose
        unit, balance = self.setting.sections.energy_scale, self.ledger.balance
        others = other_solutions(self.setting, self.current.equilibrium, self.heading)
        checks = pose.checks.but(other_solutions=others)
        return pose.but(work=balance.work * unit, dissipation=balance.loss * unit, checks=checks)


def holds(equilibrium: Equilibrium) -> list[tuple[Feature, str | None]]:
    """What touches and how it holds."""
    sites = equilibrium.state.sites
    return [(feature, getattr(sites[i].grip, "hold", None)) for feature, i in features(sites).items()]
