"""The largest force of the drive on each leg of a motion: kept step by step, located at the end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from gripper.answer import drive
from gripper.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.events import Along, Branch, Path
from gripper.work import Pace, cubic

_MARKS = np.linspace(0.0, 1.0, 17)
_SHARP = 1e-6  # of the step: where a peak is located to


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
    heading
        Sign of the way.
    near
        An equilibrium on the same branch.
    """

    force: float
    start: float
    stop: float
    heading: float
    near: Along

    @classmethod
    def of(cls, start: float, first: Pace, stop: float, last: Pace, near: Along) -> Peak:
        """The largest force on a step without a jump of rates."""
        heading = float(np.sign(stop - start))
        force = float(np.max(heading * cubic(first.power, last.power, stop - start, _MARKS)))
        return cls(force, start, stop, heading, near)

    def located(self, setting: Setting, path: Path, order: int) -> Top:
        """The largest force, on equilibria of this step."""
        branch = Branch(setting, path, self.near, order)

        def against(parameter: float) -> float:
            return -self.heading * drive(branch.at(parameter))

        ends = sorted((self.start, self.stop))
        try:
            found = minimize_scalar(
                against, bounds=ends, method="bounded", options={"xatol": _SHARP * (ends[1] - ends[0])}
            )
            places = [*ends, float(found.x)]
            values = [against(place) for place in places]
        except NoEquilibriumError:
            return Top(self.force, (self.start + self.stop) / 2)
        best = int(np.argmin(values))
        return Top(-values[best], places[best], branch.at(places[best]))
