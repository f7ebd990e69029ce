"""Following an equilibrium along a motion: bounded steps, halved where Newton fails or jumps; damped where it ends."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from gripper.objects import Array
from gripper.verify.motion import Frame, Path, travel
from gripper.verify.newton import NoSolutionError, Solution, System
from gripper.verify.outline import inside
from gripper.verify.touch import History

LONGEST = 0.15  # of L: a step without friction
ROUGH = 0.05  # of L: with friction, where the way matters
TURNING = 5e-3  # of L: where slip turns, as a longer step would see the net slip alone
MEETING = 2e-3  # of L: where the finger meets the object; a tenth of its thickness where that is less
SHORTEST = 1e-4  # of L: where steps this short fail, the equilibrium has ended, or needs damping to be found
GROWTH = 1.5  # of a step on the one before
DEEPEST = 1e-3  # of the thickness: a deeper contact is no answer
THINNEST = 1e-3  # of L: steps no shorter than this for a thin object's sake
JUMP = 1e-2  # of L: a larger motion of a node is a snap
_FURTHEST = 20.0  # of L: beyond this no retreat is tried
_STILL = 1e-3  # slip over the object's way: less is none
_AHEAD = 1e-3  # of L: how far the motion is looked ahead for the sense of its first slip
_DESCENTS = 200
_LOOSE = 1e-7  # of E b: drag that an equilibrium does not need any more


@dataclass(frozen=True, eq=False)
class Setting:
    """What does not change along a motion.

    Parameters
    ----------
    system
        Finger and object.
    stiffness
        E b, in N/m.
    length, thickness
        L, and the smallest thickness, in m.
    reach
        Largest distance of the object's matter from its origin that counts for a turn, in m.
    inner_point, inner_radius
        Of the object, in its frame, in m.
    """

    system: System
    stiffness: float
    length: float
    thickness: float
    reach: float
    inner_point: Array
    inner_radius: float


class Follower:
    """An equilibrium that follows its object.

    Parameters
    ----------
    setting
        Finger and object.
    path
        The object's frames.
    start
        Parameter at which to begin.
    towards
        Parameter to which the motion goes from there; the start itself without a motion.
    approach
        Direction along which the object comes there where it does not start free. With a motion this way is no part of
        it and leaves no friction behind: the first pose slides as the motion does.

    Raises
    ------
    NoSolutionError
        No retreat frees the finger, or the approach could not be followed.
    """

    def __init__(
        self, setting: Setting, path: Path, start: float, towards: float, approach: tuple[float, float]
    ) -> None:
        self.setting, self.system = setting, setting.system
        self.snapped = False
        self.iterations, self.depth = 0, 0.0
        self._bound = np.inf
        unit = approach[0] / math.hypot(*approach), approach[1] / math.hypot(*approach)
        unknowns = self.system.body.start
        positions = self.system.body.positions(unknowns)
        back = self._retreat(path(start), positions, unit)
        frame = path(start).shifted(unit, -back)
        self.history = History(positions, frame, np.zeros(self.system.contact.count))
        self._solution = Solution(unknowns, positions, self.system.contact.touch(positions, frame, self.history), 0)
        self._forget()
        if back:
            slides = self.system.contact.rough and travel(path(start), path(towards), setting.reach) > 0
            if slides:
                self.system = replace(self.system, contact=self.system.contact.rubbed(0.0))
            self._path: Path = lambda distance: path(start).shifted(unit, distance)
            self._at = -back
            self.advance(0.0)
            if slides:
                self._slide(path, start, towards)
        self._path, self._at, self.snapped = path, start, False
        self._forget()

    def _forget(self) -> None:
        """Expect nothing of the next step: the way before it was another."""
        self._rate = np.zeros_like(self._solution.unknowns)
        self._slip, self._pace = np.zeros(4), 0.0

    def _slide(self, path: Path, start: float, towards: float) -> None:
        """Rub as the motion will, from an equilibrium without friction on."""
        contact, frame = self.setting.system.contact, path(start)
        way = travel(frame, path(towards), self.setting.reach)
        ahead = path(start + (towards - start) * min(1.0, _AHEAD * self.setting.length / way))
        smooth = self.system.solve(self._solution.unknowns, ahead, self.history)
        contact = contact.sliding(contact.touch(smooth.positions, ahead, self.history))
        for share in (0.25, 0.5, 0.75, 1.0):
            self.system = replace(self.system, contact=contact.rubbed(share))
            self._accept(start, frame, self.system.solve(self._solution.unknowns, frame, self.history))
        self.system = self.setting.system

    def _retreat(self, frame: Frame, positions: Array, unit: tuple[float, float]) -> float:
        """How far back along its approach the object leaves the straight finger free, in m."""
        pace = float(np.clip(self.setting.inner_radius / 2, 0.01 * self.setting.length, 0.1 * self.setting.length))
        back = 0.0
        while not self._clear(frame.shifted(unit, -back), positions):
            back += pace
            if back > _FURTHEST * self.setting.length:
                raise NoSolutionError(f"the object holds the finger however far it retreats against {unit}")
        return back

    def _clear(self, frame: Frame, positions: Array) -> bool:
        """Whether finger and object lie outside each other."""
        if self.system.contact.gap(positions, frame) <= 0:
            return False
        inner = np.vstack([self.setting.inner_point[None], self.system.contact.corners.points])
        return not np.any(inside(frame.place(inner), positions, self.system.contact.edges))

    def advance(self, target: float) -> Solution:
        """The equilibrium at a value of the parameter.

        Raises
        ------
        NoSolutionError
            No equilibrium could be followed that far; the follower stays at the last one.
        """
        self.snapped = False
        while self._at != target:
            following, distance = self._within(target)
            try:
                self._step(following)
                self._bound = max(self._bound, GROWTH * distance)
            except ArithmeticError as error:
                self._bound = distance / 2
                if self._bound < SHORTEST * self.setting.length:
                    self._snap(following, error)
                    self._bound = 1e-3 * self.setting.length
        self.depth = max(0.0, -self.system.contact.gap(self.history.positions, self.history.frame))
        if self.depth > DEEPEST * self.setting.thickness:
            raise NoSolutionError(f"the object is {self.depth:.2g} m inside the finger: finer elements may resolve it")
        return self._solution

    def _within(self, target: float) -> tuple[float, float]:
        """The next parameter, and how far the object moves until there, in m."""
        L = self.setting.length
        longest = (ROUGH if self.system.contact.rough else LONGEST) * L
        room = min(longest, max(self.setting.inner_radius / 2, THINNEST * L), self._bound)
        distance = self._travel(target)
        steps = math.ceil(distance / room)
        following = self._at + (target - self._at) / max(steps, 1)
        return (target, distance) if steps <= 1 or following == self._at else (following, distance / steps)

    def _travel(self, target: float) -> float:
        marks = [self._path(self._at + (target - self._at) * i / 8) for i in range(9)]
        return sum(travel(a, b, self.setting.reach) for a, b in pairwise(marks))

    def _step(self, following: float) -> None:
        """Go on along the last step's direction, and correct."""
        frame = self._path(following)
        distance = travel(self.history.frame, frame, self.setting.reach)
        start = self._solution.unknowns + self._rate * distance
        solution = self.system.solve(start, frame, self.history)
        if self._rate.any():
            expected = self.system.body.positions(start)
            moved = float(np.max(np.abs(expected - self.history.positions)))
            if np.max(np.abs(solution.positions - expected)) > moved + distance / 2:
                raise NoSolutionError("the step departs from its prediction")
        if solution.touch.at.size and not self.system.stable(solution):
            raise NoSolutionError("the equilibrium is not stable")
        if self.system.contact.rough and distance:
            self._meet(solution, distance)
            self._turn(solution, frame, distance)
        if distance and self._solution.touch.at.size:
            self._rate = (solution.unknowns - self._solution.unknowns) / distance
        self._accept(following, frame, solution)

    def _meet(self, solution: Solution, distance: float) -> None:
        """Refuse a longer step that meets the object anew: what it moved before would count as slip."""
        short = min(MEETING * self.setting.length, self.setting.thickness / 10)
        contact, before = self.system.contact, self._solution.touch
        if distance > short and solution.touch.elsewhere(before, contact.part, len(contact.places.edge), distance):
            raise NoSolutionError("the finger meets the object within the step")

    def _turn(self, solution: Solution, frame: Frame, distance: float) -> None:
        """Refuse a step at whose end a contact, by the trend of its slip over two steps, slips the other way."""
        touch = solution.touch
        slip = touch.slip(self.history, frame, self.system.contact.part[touch.edge]) / distance
        trend = (slip - self._slip) * distance / (distance + self._pace)
        turns = (self._slip * slip != 0) & (slip * (slip + trend) < 0) & (np.abs(trend) > _STILL)
        if distance > TURNING * self.setting.length and np.any(turns):
            raise NoSolutionError("slip turns within the step")
        self._slip, self._pace = slip, distance

    def _accept(self, parameter: float, frame: Frame, solution: Solution) -> None:
        friction = np.zeros(self.system.contact.count)
        friction[solution.touch.at] = solution.touch.friction
        if not solution.touch.at.size:
            self._rate = np.zeros_like(self._rate)
        self.history = History(solution.positions, frame, friction)
        self._solution, self._at = solution, parameter
        self.iterations += solution.iterations

    def _snap(self, following: float, error: ArithmeticError) -> None:
        """Let the finger go, heavily damped, from an equilibrium that has ended to the next one."""
        frame, body, L = self._path(following), self.system.body, self.setting.length
        scale = np.full(body.size, self.setting.stiffness)
        scale[body.size - body.moves_jaw :] *= L**2
        drag, floor, before = 1e-2, 0.0, self.history.positions
        for _ in range(_DESCENTS):
            damped = replace(self.system, drag=drag * scale, anchor=self._solution.unknowns)
            try:
                solution = damped.solve(self._solution.unknowns, frame, self.history)
            except ArithmeticError:
                drag, floor = 8 * drag, 2 * drag
                continue
            moved = float(np.max(np.abs(solution.positions - self.history.positions)))
            self._accept(following, frame, solution)
            drag, floor = max(drag / 3, floor), floor / 1.5
            if drag < _LOOSE and moved < JUMP * L:
                self._forget()
                self._step(following)
                self.snapped |= bool(np.max(np.abs(self.history.positions - before)) > JUMP * L)
                return
        raise NoSolutionError(f"no equilibrium to follow, and none found by descent: {error}")
