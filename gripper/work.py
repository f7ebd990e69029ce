"""Work put in and energy lost along a motion with friction, and what happens between the ends of a step.

At an equilibrium the power of the drive, the dissipation and the contacts' margins are known together with their
rates, by a small step along the tangent: one linearisation. So a step is integrated by the corrected trapezoidal rule
(error of fifth order), and a margin that dips below zero inside it shows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.branch import Along, Path
from gripper.contact import linearise
from gripper.contact_forces import drive
from gripper.equilibrium import Equilibrium, Setting, predicted
from gripper.holds import coefficient, leaders, tangent
from gripper.rubbing import dissipation

STILL = 1e-12
"""Of L: object and clamp do not move against each other."""
_SMALL = 1e-5  # of L: the step along the tangent


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


@dataclass(frozen=True)
class Balance:
    """Energy since the motion began, over EI(0) / L.

    Parameters
    ----------
    work
        Put in by the drive, less what it got back.
    loss
        Lost in friction.
    put_in, given_back
        The two parts of the work: where the drive works, and where it is driven.
    """

    work: float = 0.0
    loss: float = 0.0
    put_in: float = 0.0
    given_back: float = 0.0

    def plus(self, start: Pace, stop: Pace, way: float) -> Balance:
        """The balance after a step without a jump of rates."""
        work = integral(start.power, stop.power, way)
        loss = max(integral(start.loss, stop.loss, way), 0.0)
        put_in, given_back = _split(start.power, stop.power, way, work)
        return Balance(self.work + work, self.loss + loss, self.put_in + put_in, self.given_back + given_back)


def speed(equilibrium: Equilibrium) -> float:
    """How fast object and clamp move against each other, by L per unit of the parameter."""
    frame = equilibrium.obstacle.frame
    return abs(frame.velocity) + abs(frame.spin)


def pace(setting: Setting, path: Path, at: Along, heading: float) -> Pace:
    """The pace of an equilibrium.

    Raises
    ------
    NoEquilibriumError
        At a limit point.
    """
    further, step = nudged(setting, path, at, heading)
    now = _numbers(at.equilibrium, heading)
    if not step:
        return _still(now)
    return _tabled(now, (_numbers(further, heading) - now) / step)


def nudged(setting: Setting, path: Path, at: Along, heading: float) -> tuple[Equilibrium, float]:
    """The state a little further along the tangent, and how far; 0 where object and clamp do not move.

    Raises
    ------
    NoEquilibriumError
        At a limit point.
    """
    equilibrium = at.equilibrium
    fast = speed(equilibrium)
    if fast < STILL:
        return equilibrium, 0.0
    small = heading * _SMALL / fast
    state = predicted(setting, equilibrium, small)
    obstacle = setting.obstacle(path.frame(at.parameter + small))
    lin = linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers)
    return Equilibrium(state, obstacle, lin, 0), small


BESIDE = (1, 2, 3)
"""How many parts aside of a change its pace is drawn from."""


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


def _still(numbers: Array) -> Pace:
    """The pace where object and clamp do not move against each other."""
    return _tabled(numbers, np.zeros_like(numbers))


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


def integral(start: Array, stop: Array, way: float) -> float:
    """The integral over a step of what is known at both ends with its rates: the corrected trapezoidal rule."""
    return float(way * (start[0] + stop[0]) / 2 + way**2 * (start[1] - stop[1]) / 12)


def cubic(start: Array, stop: Array, way: float, t: Array) -> Array:
    """What is known at both ends with its rates, at parts t (k,) of the way."""
    values: Array = np.array([start[0], start[1] * way, stop[0], stop[1] * way]) @ _hermite(t)
    return values


def _split(start: Array, stop: Array, way: float, whole: float) -> tuple[float, float]:
    """Work put in and given back over a step: cut where the power changes its sign (a cubic's root)."""
    if start[0] * stop[0] >= 0:
        return (whole, 0.0) if whole > 0 else (0.0, -whole)
    t = np.linspace(0.0, 1.0, 65)
    power = cubic(start, stop, way, t)
    forth = float(np.trapezoid(np.maximum(power * np.sign(way), 0.0), t)) * abs(way)
    return max(forth, whole, 0.0), max(forth, whole, 0.0) - whole


def _hermite(t: Array) -> Array:
    """Weights (4, k) of value and slope at 0, value and slope at 1, for a cubic at t (k,)."""
    weights: Array = np.stack([(1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2, t**2 * (3 - 2 * t), t**2 * (t - 1)])
    return weights


def dips(start: Pace, stop: Pace, way: float) -> bool:
    """Whether a margin that is positive at both ends is negative in between: cubics through values and rates."""
    if start.margins.shape != stop.margins.shape or not len(start.margins):
        return False
    (a, b), (c, d) = start.margins.T, stop.margins.T
    values = np.stack([a, way * b, c, way * d], axis=1) @ _hermite(np.linspace(0.0, 1.0, 9)[1:-1])
    slack = 1e-6 * np.maximum(np.abs(a), np.abs(c))
    return bool(np.any(values.min(axis=1) < -slack))
