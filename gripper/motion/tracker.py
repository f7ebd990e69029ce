"""Following an equilibrium along a path of the object, pose by pose, from where the finger is free.

A step is bounded by what the object and the finger can pass without tunnelling, predicted along the tangent of the
KKT system, corrected by Newton, verified, and compared with its prediction; in doubt it is halved. Where halving
does not help, the equilibrium has ended: the finger snaps.
"""

from __future__ import annotations

import math

import numpy as np

from gripper.contact.features import transition
from gripper.contact.site import Site
from gripper.motion.branch import Along, Path
from gripper.motion.events import Change, MovedOnError, changes, check_unbroken
from gripper.motion.exchange import exchanged
from gripper.motion.falling import BEYOND, Falls, alike
from gripper.motion.stride import SHORTEST, Stride, check_moved
from gripper.motion.touching import just_touched, touched
from gripper.motion.trail import Trail
from gripper.motion.watch import Watch
from gripper.result import PoseResult
from gripper.results.loop import Loop
from gripper.statics.active import find, held
from gripper.statics.answer import Answer, discretisation_error
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, reckoned
from gripper.statics.handed import handed_on, with_deepest
from gripper.statics.newton import unloaded
from gripper.statics.settling import settle_contacts
from gripper.statics.snap import distance
from gripper.statics.verified import Verified, stability, untouched, verify

_INDIVISIBLE = 5e-6  # of L: events nearer than this are one
_PATIENCE = 30  # steps that may fail on the way to a pose, or to a snap
_SETTLING = 20  # evaluations of the gaps in a step that fails
_EFFORT = 5000  # evaluations of the gaps that may be in vain on the way to a pose
_SNAPS = 3
_HIGHEST_ORDER = 14


class Tracker:
    """An equilibrium that follows its object.

    Parameters
    ----------
    setting
        Finger, theory, object.
    path
        Frames of the object over a parameter.
    parameter
        Where it starts; the finger must be free there.
    order
        Order of the strain fields to start with.
    events
        Whether to locate what changes on the way.
    free
        The verified state at the start, where it is known.

    Raises
    ------
    NoEquilibriumError
        Where the finger is not free at the start.
    """

    watch: Watch | None = None
    """Told of every step in contact, if there."""

    def __init__(
        self,
        setting: Setting,
        path: Path,
        parameter: float,
        order: int,
        *,
        events: bool = True,
        free: Verified | None = None,
    ) -> None:
        self.setting, self.path, self.parameter, self.order, self.events = setting, path, parameter, order, events
        self.stride, self.falls = Stride(setting, path), Falls(setting, path)
        self.changes: list[Change] = []
        self.iterations = 0
        self._ended: tuple[Verified, float, NoEquilibriumError] | None = None  # a first step that led nowhere
        self._asked = math.nan
        self.trail = Trail(setting)
        self.current = free or self._free(parameter)
        if free is None and not untouched(setting, self.current):
            raise NoEquilibriumError("the finger is not free of the object at the start")

    @classmethod
    def resume(cls, setting: Setting, path: Path, parameter: float, order: int, current: Verified) -> Tracker:
        """A tracker that goes on from an equilibrium reached along another path."""
        tracker = cls(setting, path, parameter, order, free=current)
        state = current.equilibrium.state
        tracker.current = tracker._at(parameter, state) if state.sites else current
        return tracker

    def begin(self, heading: float) -> None:
        """A motion starts in contact, with that sign of its way along the parameter: without friction it is all one."""

    def account(self, pose: PoseResult) -> PoseResult:
        """The pose with what its history adds: without friction nothing."""
        return pose

    def loop(self) -> tuple[Loop | None, list[Equilibrium | None]]:
        """The loop so far, and the equilibria at its peaks: None without friction."""
        return None, []

    def advance(self, target: float) -> Answer:
        """Follow the path to a value of its parameter.

        Raises
        ------
        NoEquilibriumError
            Where no equilibrium could be followed that far; the tracker stays at the last one it found.
        """
        self.stride.refuse_at_clamp(target)
        began, first = self.current, self.stride.within(self.parameter, target, np.inf, self.current)
        ended = self._ended
        if ended is not None and ended[0] is began and alike(self.parameter, ended[1], first):
            raise ended[2]  # every step would be the same again
        try:
            return self._advanced(target)
        except NoEquilibriumError as error:
            if self.current is began:
                self._ended = began, first, error
            raise

    def _advanced(self, target: float) -> Answer:
        self._asked = target
        self.iterations = failures = snaps = effort = 0
        bound = np.inf
        while self.parameter != target:
            following = self.stride.within(self.parameter, target, bound, self.current)
            try:
                with reckoned():
                    self._step(following)
                bound, failures = 2 * bound, max(failures - 1, 0)
            except NoEquilibriumError as error:
                failures, effort = failures + 1, effort + _SETTLING + error.effort
                if failures > _PATIENCE or effort > _EFFORT:
                    raise NoEquilibriumError(f"{error} (too many steps have failed on the way)") from error
                bound = self._travel(self.parameter, following) / 2
                if bound < self.stride.shortest:
                    snaps += 1
                    if snaps > _SNAPS:
                        raise NoEquilibriumError(f"the finger snaps on and on: {error}") from error
                    self._snap(self.stride.within(self.parameter, target, BEYOND, self.current), error)
                    bound, failures = 1e-3, 0
        return self._refined()

    def _travel(self, start: float, stop: float) -> float:
        """How far (by L) the object moves between two parameters."""
        return self.stride.travel(start, stop, self.current.equilibrium.state)

    @property
    def here(self) -> Along:
        """The current equilibrium and where it stands."""
        return Along(self.parameter, self.current.equilibrium)

    @property
    def sites(self) -> tuple[Site, ...]:
        """The contacts of the current equilibrium."""
        return self.current.equilibrium.state.sites

    def _free(self, parameter: float, near: State | None = None) -> Verified:
        """The finger without contacts, straight where no loads bend it, and what the object leaves of it."""
        free = unloaded(self.setting, self.setting.obstacle(self.path.frame(parameter)), self.order, near)
        return Verified(free, survey(self.setting, free.obstacle, free.state, brief=True), stability(free))

    def _at(self, parameter: float, state: State) -> Verified:
        obstacle = self.setting.obstacle(self.path.frame(parameter))
        judged = parameter == self._asked  # on the way there no error is estimated
        return verify(self.setting, settle_contacts(self.setting, obstacle, state, self.order, judged=judged))

    def _step(self, following: float) -> None:
        if not self.sites:
            free = self._free(following, self.current.equilibrium.state)
            if untouched(self.setting, free):
                self.parameter, self.current = following, free
                return
            try:
                self._accept(following, self._touched(following, free.survey))
            except MovedOnError:
                near = just_touched(self.stride, self.here, following)
                if near is None:
                    raise
                self._accept(near, self._touched(near))
            return
        self._accept(following, self._followed(following))

    def _touched(self, following: float, known: Survey | None = None) -> Verified:
        """The contacts of the finger that is free now, where the object would penetrate it."""
        return touched(self.stride, self.here, following, self.order, known)

    def _followed(self, following: float) -> Verified:
        """Predict along the tangent and correct; SLSQP where other contacts come on the way than were foreseen."""
        start = self.current.equilibrium
        guess = self.trail.predicted(self.here, following - self.parameter)
        travel = self._travel(self.parameter, following)
        expected = float(np.linalg.norm(guess.z - start.state.z))
        try:
            handed = self._handed(following, guess)
            found = self._at(following, handed)
            if found.equilibrium.correction <= 0.5 * expected + 0.05 * travel:
                return found
            if touching(found.equilibrium.state) == touching(handed):
                raise NoEquilibriumError("the step departs from its prediction")
        except NoEquilibriumError:
            if travel < 2 * SHORTEST and np.all(guess.multipliers > 0):  # no contact is about to let go
                raise
            found = self._found(following, guess)
        state = found.equilibrium.state
        check_moved((*state.sites, *self.sites), distance(state, start.state), max(travel, expected / 2))
        if travel > _INDIVISIBLE:
            self._exchange(following, found)
            before, after = self.here, Along(following, found.equilibrium)
            check_unbroken(self.setting, self.path, before, after, self.order)
        return found

    def _handed(self, following: float, guess: State) -> State:
        """A predicted state with the contacts that it tells to be next, held as those that they continue."""
        obstacle = self.setting.obstacle(self.path.frame(following))
        handed = handed_on(self.setting, obstacle, guess)
        return guess if handed is guess else held(self.setting, obstacle, self.current.equilibrium.state, handed)

    def _exchange(self, following: float, found: Verified) -> None:
        """Where one contact takes over from another within a step, go on to where both touch."""
        before, after = self.here, Along(following, found.equilibrium)
        middle = exchanged(self.setting, self.path, before, after, self.order)
        if middle is not None and (known := self._completed(*middle)):
            self._accept(middle[0], known)

    def _completed(self, parameter: float, middle: Verified) -> Verified | None:
        """What the step may go to, with what its history adds; None where it is not to go there."""
        return middle

    def _found(self, following: float, guess: State) -> Verified:
        """A place that has sunk in is one contact more; else SLSQP tells which contacts are left, or come."""
        obstacle = self.setting.obstacle(self.path.frame(following))
        known = survey(self.setting, obstacle, guess, brief=True)
        try:
            return with_deepest(self.setting, obstacle, self._handed(following, guess), known, self.order)
        except NoEquilibriumError:
            return find(self.setting, obstacle, guess, self.order, known)

    def _accept(self, following: float, found: Verified) -> None:
        """Take a step, once what changed on it is located: this proves that it stays on its branch."""
        before, after = self.here, Along(following, found.equilibrium)
        changed = self._changes(before, after) if self.events or self.sites else []
        self._book(before, after, [c.within(before.parameter, following) for c in changed if c.kind != "snap"])
        self.iterations += found.equilibrium.iterations
        self.trail.step(before, after, changed=bool(changed))
        self.parameter, self.current = following, found
        if self.events:
            self.changes += changed

    def _book(self, before: Along, after: Along, broken: list[float]) -> None:
        """Take in a step that is about to be taken, and where contacts change on it."""
        if self.watch:
            self.watch.note(before, after, broken, self.order)

    def _changes(self, before: Along, after: Along) -> list[Change]:
        """What changes on a step; on one that is as short as an event, all of it at once."""
        located = self.events or self.watch is not None
        try:
            return changes(self.setting, self.path, before, after, self.order, located=located)
        except NoEquilibriumError:
            if self._travel(before.parameter, after.parameter) > _INDIVISIBLE:
                raise
            sites = before.equilibrium.state.sites, after.equilibrium.state.sites
            return [Change(after.parameter, "change", transition(self.setting.outline, *sites))]

    def _snap(self, following: float, error: NoEquilibriumError) -> None:
        """Go on where the finger falls to from beyond its last equilibrium."""
        found, change = self.falls.fallen(self.here, following, self.order, error)
        self.iterations += found.equilibrium.iterations
        self.changes.append(change)
        self.parameter, self.current = following, found
        self.trail.forget()

    def arrive(self, parameter: float, found: Verified) -> Answer:
        """Take an equilibrium that was found at a value of the parameter for the one that is followed."""
        self.parameter, self.current, self.iterations = parameter, found, found.equilibrium.iterations
        return self._refined()

    def _refined(self) -> Answer:
        """The current equilibrium with its error estimate, of an order that meets the tolerance."""
        error = discretisation_error(self.setting, self.current.equilibrium)
        while error > self.setting.tolerance and self.order < _HIGHEST_ORDER:
            self.order += 2
            state = self.current.equilibrium.state
            self.current = self._at(self.parameter, state)
            self.trail.forget()
            self.iterations += self.current.equilibrium.iterations
            error = discretisation_error(self.setting, self.current.equilibrium)
        return Answer(self.current, error, 0.0, self.iterations)


def touching(state: State) -> list[tuple[str, int, int]]:
    """What touches what, wherever."""
    return [(site.kind, site.piece, site.vertex) for site in state.sites]


def tracker_for(setting: Setting) -> type[Tracker]:
    """The tracker that a setting needs: with friction that the motion decides, one whose contacts slip and stick."""
    if setting.friction is None or setting.friction.tipward:
        return Tracker
    from gripper.motion.frictional import FrictionTracker  # without friction it is not even read

    return FrictionTracker
