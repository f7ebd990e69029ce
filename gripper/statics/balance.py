"""Energy booked along a motion, and integrals over a step of what is known at both ends with its rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array

_MARKS = np.linspace(0.0, 1.0, 65)


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

    def plus(self, power: tuple[Array, Array], loss: tuple[Array, Array], way: float) -> Balance:
        """The balance after a step without a jump of rates: power and loss, each with its rate, (2,), at both ends."""
        work = integral(*power, way)
        put_in, given_back = _split(*power, way, work)
        lost = max(integral(*loss, way), 0.0)
        return Balance(self.work + work, self.loss + lost, self.put_in + put_in, self.given_back + given_back)

    def imbalance(self, before: Balance, stored: float) -> float:
        """What is missing: work since an earlier balance, less what was lost, less what is stored more."""
        return (self.work - before.work) - (self.loss - before.loss) - stored


def integral(start: Array, stop: Array, way: float) -> float:
    """The integral over a step of what is known at both ends with its rates: the corrected trapezoidal rule."""
    return float(way * (start[0] + stop[0]) / 2 + way**2 * (start[1] - stop[1]) / 12)


def cubic(start: Array, stop: Array, way: float, t: Array) -> Array:
    """What is known at both ends with its rates, at parts t (k,) of the way."""
    values: Array = np.array([start[0], start[1] * way, stop[0], stop[1] * way]) @ hermite(t)
    return values


def hermite(t: Array) -> Array:
    """Weights (4, k) of value and slope at 0, value and slope at 1, for a cubic at t (k,)."""
    weights: Array = np.stack([(1 + 2 * t) * (1 - t) ** 2, t * (1 - t) ** 2, t**2 * (3 - 2 * t), t**2 * (t - 1)])
    return weights


def _split(start: Array, stop: Array, way: float, whole: float) -> tuple[float, float]:
    """Work put in and given back over a step: cut where the power changes its sign (a cubic's root)."""
    if start[0] * stop[0] >= 0:
        return (whole, 0.0) if whole > 0 else (0.0, -whole)
    power = cubic(start, stop, way, _MARKS)
    forth = float(np.trapezoid(np.maximum(power * np.sign(way), 0.0), _MARKS)) * abs(way)
    return max(forth, whole, 0.0), max(forth, whole, 0.0) - whole
