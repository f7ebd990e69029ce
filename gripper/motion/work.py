"""What an equilibrium with friction does per unit of the motion, and what happens between the ends of a step.

At an equilibrium the power of the drive, the dissipation and the contacts' margins are known together with their
rates, by a small step along the tangent: one linearisation. So a step is integrated by the corrected trapezoidal rule
(error of fifth order), and a margin that dips below zero inside it shows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.contact.rubbing import dissipation
from gripper.motion.branch import Along, Path, nudged
from gripper.statics.balance import Balance, hermite
from gripper.statics.contact_forces import drive
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.statics.holds import coefficient, leaders, tangent

BESIDE = (1, 2, 3)
"""How many parts aside of a change its pace is drawn from."""
_INSIDE = hermite(np.linspace(0.0, 1.0, 9)[1:-1])


@dataclass(frozen=True, eq=False)
class Pace:
    """What an equilibrium does per unit of the motion's parameter, dimensionless, and the rates of that.

    Parameters
    ----------
    power, loss
        Work put in and energy lost, each with its rate, (2,).
    margins
        Of each leading contact: slip rates (one) or mu less the ratio and mu plus the ratio, each with its rate,
        (margins, 2).
    """

    power: Array
    loss: Array
    margins: Array

    def carried(self, way: float) -> Pace:
        """The pace a little further, at the rates here."""
        ahead = np.array([[1.0, way], [0.0, 1.0]])
        return Pace(ahead @ self.power, ahead @ self.loss, self.margins)

    @property
    def steady(self) -> Pace:
        """The pace as if it did not change."""
        level = np.array([1.0, 0.0])
        return Pace(self.power * level, self.loss * level, self.margins)


REST = Pace(np.zeros(2), np.zeros(2), np.zeros((0, 2)))
"""The pace of a finger that nothing touches."""


def booked(balance: Balance, start: Pace, stop: Pace, way: float) -> Balance:
    """The balance after a step without a jump of rates."""
    return balance.plus((start.power, stop.power), (start.loss, stop.loss), way)


def pace(setting: Setting, path: Path, at: Along, heading: float) -> Pace:
    """The pace of an equilibrium.

    Raises
    ------
    NoEquilibriumError
        At a limit point.
    """
    further, step = nudged(setting, path, at, heading)
    now = _numbers(at.equilibrium, heading)
    return _tabled(now, (_numbers(further, heading) - now) / step if step else np.zeros_like(now))


def drawn(beside: list[Equilibrium], part: float, heading: float) -> Pace:
    """The pace at a change of the contacts, from equilibria 1, 2 and 3 parts aside: parabolas through their numbers.

    Beside a contact that reaches an end of its face the tangent is not exact: the segment between both is as short as
    the stretch over which shear spreads the force.
    """
    numbers = np.array([_numbers(equilibrium, heading) for equilibrium in beside])
    here, rates = np.array([3.0, -3.0, 1.0]) @ numbers, np.array([-2.5, 4.0, -1.5]) @ numbers
    return _tabled(here, rates / part)


def _tabled(numbers: Array, rates: Array) -> Pace:
    table = np.column_stack([numbers, rates])
    return Pace(table[0], table[1], table[2:])


def _numbers(equilibrium: Equilibrium, heading: float) -> Array:
    """Power, dissipation and the margins of an equilibrium."""
    rates = tangent(equilibrium)[0]
    rubbing = equilibrium.linear.rubbing
    if rubbing is None:
        return np.array([drive(equilibrium), 0.0])
    slips = rubbing.gradients @ rates + rubbing.rates
    margins: list[float] = []
    for i in leaders(equilibrium):
        grip = equilibrium.state.sites[i].grip
        if grip is not None and grip.hold == "slip":
            margins.append(float(slips[i]) * grip.sense * heading)
        elif grip is not None:
            mu = coefficient(equilibrium, i)
            margins += [mu - grip.ratio, mu + grip.ratio]
    return np.array([drive(equilibrium), dissipation(rubbing, rates), *margins])


def dips(start: Pace, stop: Pace, way: float) -> bool:
    """Whether a margin that is positive at both ends is negative in between: cubics through values and rates."""
    if start.margins.shape != stop.margins.shape or not len(start.margins):
        return False
    (a, b), (c, d) = start.margins.T, stop.margins.T
    values = np.stack([a, way * b, c, way * d], axis=1) @ _INSIDE
    slack = 1e-6 * np.maximum(np.abs(a), np.abs(c))
    return bool(np.any(values.min(axis=1) < -slack))
