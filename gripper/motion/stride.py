"""How far the object may go in one step of a motion, and how far the finger may move with it."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Sequence

import numpy as np

from gripper.contact.obstacle import Frame
from gripper.contact.site import Site
from gripper.motion.branch import Path
from gripper.statics.acting import Acting
from gripper.statics.clearance import clearance
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.sampling import DEPTH
from gripper.statics.verified import Verified

ON_CLAMP = "the object lies on the clamp"
"""The reason of a pose that no bending frees."""
SHORTEST = 1e-6
"""Of L: where steps this short do not succeed, there is no equilibrium to follow."""
_LONGEST = 0.1  # of L
_SHALLOW = 0.02  # of L: how deep a sharp corner may sink before the first contact is looked for
_SMALLER = 0.05  # of the object's inner radius: the same for one that is smaller still
_ALONG = np.linspace(0.0, 1.0, 33)
_ROUGHLY = 0.02  # of a step: how well the way to the object is known
_PARTS = 2  # in which a step's path is measured


class Stride:
    """The measure of steps along a path of the object.

    Parameters
    ----------
    setting
        Finger, theory, object.
    path
        Frames of the object over a parameter.
    """

    def __init__(self, setting: Setting, path: Path) -> None:
        self.setting, self.path = setting, path
        length, body = setting.sections.length, setting.body
        self.deep = body.inner_radius / length
        self.shortest = min(SHORTEST, _SMALLER * self.deep)
        """Of L: shorter steps tell that there is nothing more to follow."""
        size = max(map(abs, body.box)) / length
        self._reach = min(size * math.sqrt(2.0), 2.0)
        self._outer = size * math.sqrt(2.0) + float(np.abs(setting.clamped).max())
        self._sink = _SHALLOW if len(body.corners) else _LONGEST
        self._travelled = (math.nan, math.nan, 0.0)

    def refuse_at_clamp(self, parameter: float) -> None:
        """No bending frees a finger of an object that lies on its clamp.

        Raises
        ------
        NoEquilibriumError
            Where the clamped section lies in the object.
        """
        frame = self.path.frame(parameter)
        if abs(frame.origin) > self._outer:
            return
        if float(self.setting.obstacle(frame).gap(self.setting.clamped).min()) < -DEPTH:
            raise NoEquilibriumError(ON_CLAMP)

    def within(self, start: float, target: float, bound: float, current: Verified) -> float:
        """The furthest parameter towards the target that the next step from ``start`` may reach.

        Parameters
        ----------
        start, target
            Parameters of the path.
        bound
            On the step, by L.
        current
            The equilibrium at the start.
        """
        state = current.equilibrium.state
        room, travel = min(bound, self._safe(state.sites)), self.travel(start, target, state)
        if travel > room and not state.sites and bound > room:
            proved = max(current.survey.least, 0.0)  # a lower bound that is there already
            slack = _ROUGHLY * room
            clear = proved if room + proved >= travel else clearance(self.setting, current, slack) - slack
            room = min(bound, room + max(clear, 0.0))
        if travel <= room:
            return target
        following = start + (target - start) * room / travel
        return target if following == start else following

    def _safe(self, sites: tuple[Site, ...]) -> float:
        """How far (by L) the object may move relative to the clamp without passing through anything unseen."""
        if sites:
            return min(max(self.deep, self._thin), 2 * _LONGEST)
        return min(self.deep / 2, self._sink)

    @functools.cached_property
    def _thin(self) -> float:
        """How far (by L) any object that touches may move without passing through the finger's thickness unseen."""
        if self.setting.outline.jaw is not None:
            return 0.0
        return min(float(np.min(self.setting.sections.thickness(_ALONG))) / 4, _SHALLOW)

    def travel(self, start: float, stop: float, state: State) -> float:
        """Length of the object's relative path (by L), its turning included, and of what changing loads move."""
        if self._travelled[:2] != (start, stop):
            way = stop - start
            frames = [self.path.frame(start + way * i / (2 * _PARTS)) for i in range(2 * _PARTS + 1)]
            self._travelled = start, stop, self._length(frames, abs(way)) + self._swayed(frames, state)
        return self._travelled[2]

    def _length(self, frames: Sequence[Frame], way: float) -> float:
        """The longer of the polygon through the frames and the integral of their speeds (Simpson's rule)."""
        reach = self._reach
        pairs = itertools.pairwise(frames)
        chords = math.fsum([abs(b.origin - a.origin) + reach * abs(b.angle - a.angle) for a, b in pairs])
        speeds = [abs(frame.velocity) + reach * abs(frame.spin) for frame in frames]
        whole = speeds[0] + 4 * sum(speeds[1::2]) + 2 * sum(speeds[2:-1:2]) + speeds[-1]
        return max(chords, whole * way / (6 * _PARTS))

    def _swayed(self, frames: Sequence[Frame], state: State) -> float:
        """About how far (by L) the loads move the finger where they change: as a cantilever's tip, sqrt(3) d = |z|."""
        loads = self.setting.loads
        if loads is None or loads.steady:
            return 0.0
        forces = np.array([Acting(loads, frame.stage).push(state.axis).force for frame in frames])
        return float(np.linalg.norm(np.diff(forces, axis=0), axis=1).sum() / np.sqrt(3.0))


def check_moved(sites: Sequence[Site], moved: float, travel: float) -> None:
    """A finger moves with its object: by as much, or as much more as its tip lies beyond the contact.

    Parameters
    ----------
    sites
        Contacts before and after the step.
    moved, travel
        How far finger and object have moved, by L.

    Raises
    ------
    NoEquilibriumError
        Where it has moved further: another branch.
    """
    places = [site.middle for site in sites if site.on_face and site.place]
    lever = 2.0 / max(min(places, default=1.0), 0.05)
    if moved > lever * 1.5 * travel + 1e-9:
        raise NoEquilibriumError("the step leads to another branch")
