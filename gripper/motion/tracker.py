"""Following an equilibrium along a path of the object, pose by pose, from where the finger is free.

A step is bounded by what the object and the finger can pass without tunnelling, predicted along the tangent of the
KKT system, corrected by Newton, verified, and compared with its prediction; in doubt it is halved. Where halving
does not help, the equilibrium has ended: the finger snaps.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import replace

import numpy as np

from gripper.contact.features import transition
from gripper.contact.linear import linearise
from gripper.contact.obstacle import Frame
from gripper.contact.site import Site, pointed
from gripper.motion.branch import Along, Path
from gripper.motion.events import STRUT, Change, MovedOnError, changes, check_unbroken, head_on, touched_at
from gripper.motion.exchange import exchanged
from gripper.motion.trail import Trail
from gripper.motion.watch import Watch
from gripper.result import PoseResult
from gripper.results.loop import Loop
from gripper.statics.acting import Acting
from gripper.statics.active import find
from gripper.statics.answer import Answer, discretisation_error
from gripper.statics.certificate import DEPTH, Survey, survey
from gripper.statics.clearance import clearance
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, reckoned
from gripper.statics.newton import unloaded
from gripper.statics.settling import settle_contacts
from gripper.statics.snap import descend, distance
from gripper.statics.verified import Verified, stability, untouched, verify

ON_CLAMP = "the object lies on the clamp"
"""The reason of a pose that no bending frees."""
NUDGE = 1e-7
"""Of L: how far beyond the first touch its contacts, and how they hold, are found."""
_LONGEST = 0.1  # of L
_SHALLOW = 0.02  # of L: how deep a sharp corner may sink before the first contact is looked for
_BEYOND = 2e-3  # of L: how far behind a limit point the descent starts
_INDIVISIBLE = 2e-6  # of L: events nearer than this are one
_SHORTEST = 1e-6  # of L: where steps this short do not succeed, there is no equilibrium to follow
_SMALLER = 0.05  # of the object's inner radius: the same for one that is smaller still
_PATIENCE = 30  # steps that may fail on the way to a pose, or to a snap
_SETTLING = 20  # evaluations of the gaps in a step that fails
_EFFORT = 4000  # evaluations of the gaps that may be in vain on the way to a pose
_SNAPS = 3
_HIGHEST_ORDER = 14
_DEPARTS = 0.5  # of a step: what it may differ from its prediction
_LEAVES = "the equilibrium ends here: the finger leaves for another"
_ALONG = np.linspace(0.0, 1.0, 33)
_TURNS = 8  # parts in which a step's path is measured


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
        self.changes: list[Change] = []
        self._fell: tuple[Verified, float, NoEquilibriumError] | None = None  # a descent that came to nothing
        self.iterations = 0
        self._asked = math.nan
        self.trail = Trail(setting)
        self._travelled = (math.nan, math.nan, 0.0)
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
        self._refuse_at_clamp(target)
        self._asked = target
        self.iterations = failures = snaps = effort = 0
        bound = np.inf
        while self.parameter != target:
            following = self._within(target, bound)
            try:
                with reckoned():
                    self._step(following)
                bound, failures = 2 * bound, max(failures - 1, 0)
            except NoEquilibriumError as error:
                failures, effort = failures + 1, effort + _SETTLING + error.effort
                if failures > _PATIENCE or effort > _EFFORT:
                    raise NoEquilibriumError(f"{error} (too many steps have failed on the way)") from error
                bound = self._travel(self.parameter, following) / 2
                if bound < min(_SHORTEST, _SMALLER * self.setting.body.inner_radius / self.setting.sections.length):
                    snaps += 1
                    if snaps > _SNAPS:
                        raise NoEquilibriumError(f"the finger snaps on and on: {error}") from error
                    self._snap(self._within(target, _BEYOND), error)
                    bound, failures = 1e-3, 0
        return self._refined()

    def _refuse_at_clamp(self, parameter: float) -> None:
        """No bending frees a finger of an object that lies on its clamp.

        Raises
        ------
        NoEquilibriumError
            Where the clamped section lies in the object.
        """
        obstacle = self.setting.obstacle(self.path.frame(parameter))
        if float(obstacle.gap(self.setting.clamped).min()) < -DEPTH:
            raise NoEquilibriumError(ON_CLAMP)

    def _within(self, target: float, bound: float) -> float:
        """The furthest parameter towards the target that the next step may reach."""
        room, travel = min(bound, self._safe_travel()), self._travel(self.parameter, target)
        if travel > room and not self.sites and bound > room:
            proved = max(self.current.survey.least, 0.0)  # a lower bound that is there already
            clear = proved if room + proved >= travel else clearance(self.setting, self.current)
            room = min(bound, room + max(clear, 0.0))
        if travel <= room:
            return target
        following = self.parameter + (target - self.parameter) * room / travel
        return target if following == self.parameter else following

    def _safe_travel(self) -> float:
        """How far (by L) the object may move relative to the clamp without passing through anything unseen."""
        deep = self.setting.body.inner_radius / self.setting.sections.length
        if self.sites:
            return min(max(deep, self._thin), 2 * _LONGEST)
        sink = _SHALLOW if len(self.setting.body.corners) else _LONGEST
        return min(deep / 2, sink)

    @functools.cached_property
    def _thin(self) -> float:
        """How far (by L) any object that touches may move without passing through the finger's thickness unseen."""
        if self.setting.outline.jaw is not None:
            return 0.0
        return min(float(np.min(self.setting.sections.thickness(_ALONG))) / 4, _SHALLOW)

    def _travel(self, start: float, stop: float) -> float:
        """Length of the object's relative path (by L), its turning included, and of what changing loads move."""
        if self._travelled[:2] != (start, stop):
            frames = [self.path.frame(start + (stop - start) * i / _TURNS) for i in range(_TURNS + 1)]
            size = max(map(abs, self.setting.body.box)) / self.setting.sections.length
            reach = min(size * math.sqrt(2.0), 2.0)
            moved = [abs(b.origin - a.origin) + reach * abs(b.angle - a.angle) for a, b in itertools.pairwise(frames)]
            self._travelled = start, stop, math.fsum(moved) + self._swayed(frames)
        return self._travelled[2]

    def _swayed(self, frames: list[Frame]) -> float:
        """About how far (by L) the loads move the finger where they change: as a cantilever's tip, sqrt(3) d = |z|."""
        loads = self.setting.loads
        if loads is None or loads.steady:
            return 0.0
        axis = self.current.equilibrium.state.axis
        forces = np.array([Acting(loads, frame.stage).push(axis).force for frame in frames])
        return float(np.linalg.norm(np.diff(forces, axis=0), axis=1).sum() / np.sqrt(3.0))

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
                near = self._just_touched(following)
                if near is None:
                    raise
                self._accept(near, self._touched(near))
            return
        self._accept(following, self._followed(following))

    def _just_touched(self, following: float) -> float | None:
        """A little beyond the first touch of the free finger; None where that is the step's end, or it is grazed."""
        here = Along(self.parameter, self.current.equilibrium)
        touch = touched_at(self.setting, self.path, here, following)
        rest = 0.0 if touch is None else self._travel(touch, following)
        return touch + (following - touch) * NUDGE / rest if touch is not None and rest > NUDGE else None

    def _touched(self, following: float, known: Survey | None = None) -> Verified:
        """The finger is free now and the object would penetrate it: SLSQP finds the contacts."""
        start = self.current.equilibrium.state
        obstacle = self.setting.obstacle(self.path.frame(following))
        try:
            found = find(self.setting, obstacle, start, self.order, known)
            moved, travel = distance(found.equilibrium.state, start), self._travel(self.parameter, following)
            self._compare(found, moved, travel)
            if distance(found.equilibrium.state, self._pushed(found)) > _DEPARTS * moved:
                raise NoEquilibriumError("the step departs from its prediction")
        except NoEquilibriumError as error:
            if head_on(self.setting, self.path, Along(self.parameter, self.current.equilibrium), following):
                raise NoEquilibriumError(STRUT, error.effort) from error
            raise
        return found

    def _pushed(self, found: Verified) -> State:
        """The free finger bent by the least energy that closes the gaps where it touches now, to first order."""
        sites = tuple(pointed(site) for site in found.equilibrium.state.sites)
        beam, obstacle, none = self.setting.beam(sites, self.order), found.equilibrium.obstacle, np.zeros(len(sites))
        state = State(beam, np.zeros(beam.size))
        if obstacle.acting is not None:
            state = unloaded(self.setting, obstacle, self.order, self.current.equilibrium.state).state.on(beam)
        lin = linearise(state.beam, state.z, self.setting.outline, obstacle, sites, none, kinks=False)
        if lin.push is None:
            return replace(state, z=np.linalg.lstsq(lin.gradients, -lin.values)[0])
        yielding = np.linalg.solve(state.energy_hessian - lin.hessian, lin.gradients.T)
        return replace(state, z=state.z + yielding @ np.linalg.lstsq(lin.gradients @ yielding, -lin.values)[0])

    def _followed(self, following: float) -> Verified:
        """Predict along the tangent and correct; SLSQP where the contacts change on the way."""
        start = self.current.equilibrium
        guess = self.trail.predicted(Along(self.parameter, start), following - self.parameter)
        travel = self._travel(self.parameter, following)
        expected = float(np.linalg.norm(guess.z - start.state.z))
        try:
            found = self._at(following, guess)
            if found.equilibrium.correction > 0.5 * expected + 0.05 * travel:
                raise NoEquilibriumError("the step departs from its prediction")
        except NoEquilibriumError:
            if travel < 2 * _SHORTEST and not self._loosens(guess):
                raise
            found = self._found(following, guess)
            self._compare(found, distance(found.equilibrium.state, start.state), max(travel, expected / 2))
            if travel > _INDIVISIBLE:
                self._exchange(following, found)
                before, after = Along(self.parameter, self.current.equilibrium), Along(following, found.equilibrium)
                check_unbroken(self.setting, self.path, before, after, self.order)
        return found

    def _exchange(self, following: float, found: Verified) -> None:
        """Where one contact takes over from another within a step, go on to where both touch."""
        before, after = Along(self.parameter, self.current.equilibrium), Along(following, found.equilibrium)
        middle = exchanged(self.setting, self.path, before, after, self.order)
        if middle is not None and (known := self._completed(*middle)):
            self._accept(middle[0], known)

    def _completed(self, parameter: float, middle: Verified) -> Verified | None:
        """What the step may go to, with what its history adds; None where it is not to go there."""
        return middle

    def _found(self, following: float, guess: State) -> Verified:
        """SLSQP tells which contacts are left, or come."""
        return find(self.setting, self.setting.obstacle(self.path.frame(following)), guess, self.order)

    @staticmethod
    def _loosens(predicted: State) -> bool:
        """Whether a contact's multiplier is about to change its sign."""
        return bool(np.any(predicted.multipliers <= 0))

    def _compare(self, found: Verified, moved: float, travel: float) -> None:
        """A finger moves with its object: by as much, or as much more as its tip lies beyond the contact.

        Raises
        ------
        NoEquilibriumError
            Where it has moved further: another branch.
        """
        places = [s.middle for s in (*found.equilibrium.state.sites, *self.sites) if s.on_face and s.place]
        lever = 2.0 / max(min(places, default=1.0), 0.05)
        if moved > lever * 1.5 * travel + 1e-9:
            raise NoEquilibriumError("the step leads to another branch")

    def _accept(self, following: float, found: Verified) -> None:
        """Take a step, once what changed on it is located: this proves that it stays on its branch."""
        before = Along(self.parameter, self.current.equilibrium)
        changed: list[Change] = []
        if self.events or self.sites:
            after = Along(following, found.equilibrium)
            try:
                located = self.events or self.watch is not None
                changed = changes(self.setting, self.path, before, after, self.order, located=located)
            except NoEquilibriumError:
                if self._travel(self.parameter, following) > _INDIVISIBLE:
                    raise
                sites = before.equilibrium.state.sites, after.equilibrium.state.sites
                changed = [Change(following, "change", transition(self.setting.outline, *sites))]
        self.iterations += found.equilibrium.iterations
        self.trail.step(before, Along(following, found.equilibrium), changed=bool(changed))
        self.parameter, self.current = following, found
        if self.events:
            self.changes += changed
        if self.watch:
            broken = [
                within(change.parameter, before.parameter, following) for change in changed if change.kind != "snap"
            ]
            self.watch.note(before, Along(following, found.equilibrium), broken, self.order)

    def _snap(self, following: float, error: NoEquilibriumError) -> None:
        """A little beyond the last equilibrium, where forces no longer nearly balance: descend to the next."""
        start = self.current.equilibrium.state
        if not start.sites:
            raise error
        obstacle = self.setting.obstacle(self.path.frame(following))
        on_end = all(self.setting.outline.place(site.piece, np.zeros(1))[0] == "tip" for site in start.sites)
        fell = self._fell
        if fell is not None and fell[0] is self.current and math.isclose(fell[1], following, rel_tol=1e-9):
            raise fell[2]  # at every pose beyond it would be the same descent
        try:
            found = descend(self.setting, obstacle, start, self.order)
        except NoEquilibriumError as failure:
            told = NoEquilibriumError(f"{STRUT}; {failure}" if on_end else str(failure))
            self._fell = self.current, following, told
            raise told from failure
        self.iterations += found.equilibrium.iterations
        self.changes.append(Change(self.parameter, "snap", STRUT if on_end else _LEAVES))
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


def tracker_for(setting: Setting) -> type[Tracker]:
    """The tracker that a setting needs: with friction that the motion decides, one whose contacts slip and stick."""
    if setting.friction is None or setting.friction.tipward:
        return Tracker
    from gripper.motion.frictional import FrictionTracker  # without friction it is not even read

    return FrictionTracker


def within(parameter: float, start: float, stop: float) -> float:
    """Where a step's event is on the step: a contact may be kept a little beyond its end, which then lies before it."""
    return sorted((start, parameter, stop))[1]
