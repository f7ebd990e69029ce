"""The largest force of the drive on each leg of a motion: kept step by step, located at the end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.motion.branch import Along, Branch, Path, branch_from
from gripper.motion.work import Pace, pace
from gripper.statics.balance import cubic
from gripper.statics.contact_forces import drive
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting

_MARKS = np.linspace(0.0, 1.0, 33)
_ROUNDS = 8  # of which two or three are needed: an error of fourth order in a step that shrinks each time
_LEVEL = 1e-9  # of the force: it changes by less over what is left of the step


@dataclass(frozen=True, eq=False)
class Top:
    """The largest force of a leg, where it is, and the equilibrium there, if it was found."""

    force: float
    parameter: float
    equilibrium: Equilibrium | None = None


@dataclass(frozen=True, eq=False)
class Peak:
    """The step on which the force is largest.

    Parameters
    ----------
    force
        Of the drive along the way, from a cubic over the step.
    start, stop
        Ends of the step.
    first, last
        Power of the drive at these, and its rate, (2,).
    heading
        Sign of the way.
    near
        An equilibrium on the same branch.
    """

    force: float
    start: float
    stop: float
    first: Array
    last: Array
    heading: float
    near: Along

    @classmethod
    def of(cls, start: float, first: Pace, stop: float, last: Pace, near: Along) -> Peak:
        """The largest force on a step without a jump of rates."""
        heading = float(np.sign(stop - start))
        force = float(np.max(heading * cubic(first.power, last.power, stop - start, _MARKS)))
        return cls(force, start, stop, first.power, last.power, heading, near)

    def located(self, setting: Setting, path: Path, order: int) -> Top:
        """The largest force, on an equilibrium of this step."""
        branch = branch_from(setting, path, self.near, order)
        try:
            place = self._place(setting, path, branch)
            found = branch.at(place)
        except NoEquilibriumError:
            return Top(self.force, (self.start + self.stop) / 2)
        return Top(self.heading * drive(found), place, found)

    def _place(self, setting: Setting, path: Path, branch: Branch) -> float:
        """Where the cubic through both ends is largest, again and again.

        Each round solves the equilibrium there, which cuts the step on the side on which the force rises.
        """
        start, first, stop, last = self.start, self.first, self.stop, self.last
        force, place = max((self.heading * first[0], start), (self.heading * last[0], stop))
        for _ in range(_ROUNDS):
            at = start + _summit(self.heading * first, self.heading * last, stop - start) * (stop - start)
            if at in (start, stop):
                break
            here = pace(setting, path, Along(at, branch.at(at)), self.heading).power
            if self.heading * here[0] >= force:
                force, place = self.heading * here[0], at
            if here[1] > 0:
                start, first = at, here
            else:
                stop, last = at, here
            if abs(here[1] * (stop - start)) < _LEVEL * abs(here[0]):
                break
        return float(place)


def _summit(first: Array, last: Array, way: float) -> float:
    """The part of the way at which the cubic through values and rates at both ends is largest."""
    values = cubic(first, last, way, _MARKS)
    best = int(np.argmax(values))
    if best in (0, _MARKS.size - 1):
        return float(_MARKS[best])
    a, b = first[1] * way, last[1] * way
    rise = last[0] - first[0]
    roots = np.roots([3 * (a + b - 2 * rise), 6 * rise - 4 * a - 2 * b, a])
    near = roots.real[np.argmin(np.abs(roots - _MARKS[best]))]
    return float(min(max(near, _MARKS[best - 1]), _MARKS[best + 1]))
