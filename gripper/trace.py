"""A motion: pose by pose from a free pose, events located."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from gripper.assemble import first_order, setting
from gripper.beam.strains import BeamTheory
from gripper.contact.kinematics import Kinematics
from gripper.motion.approach import approach
from gripper.motion.branch import Along
from gripper.motion.events import STRUT
from gripper.motion.located import Course, measures, ways
from gripper.motion.locked import LockedError
from gripper.motion.tracker import Tracker, tracker_for
from gripper.motion.watch import Watch
from gripper.result import Checks, Event, PoseResult, Result
from gripper.results.extremes import Extreme, Extremes
from gripper.results.loop import Loop
from gripper.scene import Scene
from gripper.solve import model, numbers
from gripper.statics.clearance import clearances
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, reckoned
from gripper.statics.ladder import rungs, suffices
from gripper.statics.verified import Verified

INTERRUPTED = "interrupted"
"""Reason of the poses that an interruption left without an answer."""


class Interrupted(KeyboardInterrupt):
    """A motion was interrupted; ``result`` holds the poses that were done, the others ``failed``: "interrupted"."""

    def __init__(self, result: Result) -> None:
        done = [pose for pose in result.poses if pose.reason != INTERRUPTED]
        super().__init__(f"{len(done)} of {len(result.poses)} poses are done")
        self.result = result


def trace(scene: Scene, progress: Callable[[int, int], None] | None = None) -> Result:
    """Follow a motion and solve each of its poses.

    A motion that starts in contact is approached first, along ``scene.approach``.

    Parameters
    ----------
    scene
        With a motion.
    progress
        Called after each pose with the number of poses done and their total.

    Returns
    -------
    All poses, failed ones with their reasons, and the events between them.

    Raises
    ------
    ValueError
        A scene without motion (solve it), a pose that is not finite, or a finger whose profile is not positive.
    Interrupted
        By Ctrl-C, once a pose is done: a KeyboardInterrupt that holds what was computed.
    """
    if scene.motion is None:
        raise ValueError("scene must have a motion (gripper.solve takes one pose); got None")
    report = _Forward(progress)
    for theory in rungs(scene):
        result = _followed(scene, scene.motion.values, theory, report)
        if suffices(scene, theory, result.poses[-1]):
            break
    return result


class _Forward:
    """Progress that never goes back: a motion that starts again with a richer theory is silent until it is as far."""

    def __init__(self, progress: Callable[[int, int], None] | None) -> None:
        self.progress, self.furthest = progress, 0

    def __call__(self, done: int, total: int) -> None:
        """Tell how many poses are done, if there are more than ever before."""
        if self.progress is not None and done > self.furthest:
            self.furthest = done
            self.progress(done, total)


def _followed(scene: Scene, values: Sequence[float], theory: BeamTheory, report: _Forward) -> Result:
    """The motion by one theory, up to the first pose that shows that it does not suffice."""
    fixed = setting(scene, theory)
    kinematics = Kinematics(scene, fixed.sections.length)
    for value in values:
        kinematics.frame(value)
    follower = _Follower(scene, fixed, kinematics)
    poses: list[PoseResult] = []
    try:
        for done, value in enumerate(values, start=1):
            poses.append(follower.pose(value))
            if not suffices(scene, theory, poses[-1]):
                break
            report(done, len(values))
    except KeyboardInterrupt:
        if not poses:
            raise
        missing = [PoseResult.failed(value, INTERRUPTED) for value in values[len(poses) :]]
        raise Interrupted(follower.result([*poses, *missing])) from None
    return follower.result(poses)


class _Follower:
    """The tracker of a motion, begun at the first pose that can be reached."""

    def __init__(self, scene: Scene, fixed: Setting, kinematics: Kinematics) -> None:
        self.scene, self.fixed, self.kinematics = scene, fixed, kinematics
        self.tracker: Tracker | None = None
        self.order = first_order(scene.tolerance)
        self.watch = Watch(fixed, kinematics, measures(scene, fixed))
        self.locked: Extreme | None = None
        self._done = 0
        self._apart: dict[int, Verified] = {}  # free poses whose distance from the object is still to be found
        self._ways = iter(ways(scene.motion.values if scene.motion else ()))

    @property
    def events(self) -> list[Event]:
        """Events so far, in the order in which they happened."""
        found = self.tracker.changes if self.tracker else []
        return [Event(parameter=c.parameter, kind=c.kind, detail=c.detail) for c in found]

    def result(self, poses: list[PoseResult]) -> Result:
        """The motion so far, with these poses."""
        poses = self.measured(poses)
        loop, peaks = self.tracker.loop() if self.tracker else (None, [])
        extremes = self.extremes(poses, loop, peaks)
        return Result(
            title=self.scene.title,
            scene=self.scene,
            model=model(self.scene, self.fixed, poses, extremes.strain),
            poses=tuple(poses),
            events=tuple(self.events),
            loop=loop,
            extremes=extremes,
        )

    def measured(self, poses: Sequence[PoseResult]) -> list[PoseResult]:
        """The motion's poses so far, with the distances from the object of those that are free: found together."""
        began, out = time.process_time(), list(poses)
        length = self.fixed.sections.length
        found = dict(zip(self._apart, clearances(self.fixed, list(self._apart.values())), strict=True))
        each = (time.process_time() - began) / max(len(found), 1)
        for i, distance in found.items():
            if out[i].status == "failed":  # interrupted before it was done
                continue
            out[i] = out[i].but(min_gap=distance * length, seconds=out[i].seconds + each)
        self._apart.clear()
        return out

    def pose(self, value: float) -> PoseResult:
        """The result at the next value of the parameter; :meth:`measured` completes a free one."""
        began = time.process_time()
        self.watch.leg, self.watch.heading = next(self._ways)
        try:
            with reckoned():
                pose = self._reached(value)
        except LockedError as error:
            self.locked = Extreme(value=error.mu / error.limit, parameter=value)
            others = Checks(other_solutions=self._if_free(value))
            pose = PoseResult(parameter=value, status="locked", reason=str(error), checks=others)
        except NoEquilibriumError as error:
            iterations = self.tracker.iterations if self.tracker else 0
            pose = PoseResult.failed(value, str(error), iterations)
        pose = self.tracker.account(pose) if self.tracker else pose
        self._done += 1
        return pose.but(seconds=time.process_time() - began)

    def _reached(self, value: float) -> PoseResult:
        """The numbers at the next value."""
        if self.tracker is None:
            self.tracker = self._begin(value)
            self.tracker.watch = self.watch
        answer = self.tracker.advance(value)
        self.watch.stand(Along(value, answer.verified.equilibrium))
        pose = numbers(self.scene, self.fixed, answer, value, self.kinematics.placement(value), measured=False)
        if pose.status != "failed" and pose.min_gap is None:
            self._apart[self._done] = answer.verified
        return pose

    def _if_free(self, value: float) -> tuple[str, ...]:
        """Where friction holds the finger: whether it might be free as well."""
        from gripper.motion.others import is_clear

        clear = is_clear(self.fixed, self.fixed.obstacle(self.kinematics.frame(value)), self.order)
        return ("free",) if clear else ()

    def extremes(self, poses: Sequence[PoseResult], loop: Loop | None, peaks: Sequence[Equilibrium | None]) -> Extremes:
        """What was largest on the way."""
        order = self.tracker.order if self.tracker else self.order
        buckled = any(event.kind == "snap" and event.detail == STRUT for event in self.events)
        course = Course(self.scene, self.fixed, self.watch, order, poses, buckled, loop, self.locked, peaks)
        return course.extremes()

    def _begin(self, value: float) -> Tracker:
        try:
            return tracker_for(self.fixed)(self.fixed, self.kinematics, value, self.order)
        except NoEquilibriumError:
            return self._approached(value)

    def _approached(self, value: float) -> Tracker:
        """A motion that starts in contact; the way there is no part of it and leaves no friction behind."""
        law = self.fixed.friction
        smooth = replace(self.fixed, friction=law if law and law.tipward else None)
        answer, order = approach(smooth, self.kinematics.frame(value), self.scene.approach, self.order)
        tracker = tracker_for(self.fixed).resume(self.fixed, self.kinematics, value, order, answer.verified)
        tracker.begin(self._heading(value))
        return tracker

    def _heading(self, value: float) -> float:
        """Where the motion goes from a value: the sign of the way along its parameter."""
        values = self.scene.motion.values if self.scene.motion else ()
        later = [v - value for v in values[values.index(value) :] if v != value]
        return -1.0 if later and later[0] < 0 else 1.0
