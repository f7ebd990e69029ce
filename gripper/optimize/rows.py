"""What is asked of a design, row by row, with gradients: what an optimiser sees of it.

A largest value that is wanted small is kept down pose by pose, its located peak among them (epigraph form): peaks may
change places as a design changes, each pose's value changes smoothly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.limits import Limits
from gripper.optimize.goal import Goal
from gripper.sensitivity.curves import CURVES, Curves

UPPER, LOWER, LIMIT = 0, 1, 2
"""Kinds of rows: below the upper level; below the lower one, negative; a limit, kept where it is not positive."""
_INSIDE = 2e-4  # relative: how much inside the limits a design is asked to stay
_SMALL = 0.1  # of its unit: below, a quantity counts by itself, not by its logarithm (it may be 0)


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of a design.

    Parameters
    ----------
    kinds
        UPPER, LOWER or LIMIT (m,).
    values
        Relative (m,): logarithms of quantities over their units, where they have any.
    slopes
        Their derivatives by x (m, n).
    """

    kinds: Array
    values: Array
    slopes: Array

    def highest(self, kind: int) -> float:
        """The largest value of a kind of rows; 0 where there are none."""
        return float(self.values[self.kinds == kind].max()) if (self.kinds == kind).any() else 0.0

    @property
    def objective(self) -> float:
        """What is minimised."""
        return self.highest(UPPER) + self.highest(LOWER)

    @property
    def excess(self) -> float:
        """By how much the worst limit is violated; 0 where all are kept."""
        return max(self.highest(LIMIT), 0.0)


@dataclass(frozen=True)
class Asked:
    """The goal and the limits as rows.

    Parameters
    ----------
    goal, limits
        What is wanted.
    unit
        Of the objective: its size at the start.
    """

    goal: Goal
    limits: Limits
    unit: float

    def rows(self, curves: Curves, slopes: Array) -> Rows:
        """Rows of a design; ``slopes`` (n,) are those of its numbers by x."""
        parts = [self._flat(curves, slopes) if self.goal.sense == "flatten" else self._objective(curves, slopes)]
        parts += [self._limit(name, bound, curves, slopes) for name, bound in self.limits.bounds]
        return Rows(*(np.concatenate([getattr(part, f) for part in parts]) for f in ("kinds", "values", "slopes")))

    def _flat(self, curves: Curves, slopes: Array) -> Rows:
        values, by = curves.along(self.goal.quantity)
        mean = values.mean()
        shape = values / mean
        rates = (by - shape[:, None] * by.mean(axis=0)) / mean * slopes
        kinds = np.repeat([UPPER, LOWER], len(shape))
        return Rows(kinds, np.concatenate([shape, -shape]), np.concatenate([rates, -rates]))

    def _objective(self, curves: Curves, slopes: Array) -> Rows:
        sign = -1.0 if self.goal.sense == "maximize" else 1.0
        values, rates = _relative(self.goal.quantity, *_levels(curves, self.goal.quantity, sign > 0), self.unit)
        return Rows(np.full(len(values), UPPER), sign * values, sign * rates * slopes)

    @staticmethod
    def _limit(name: str, bound: float, curves: Curves, slopes: Array) -> Rows:
        sign = 1.0 if name.startswith("max_") else -1.0
        values, rates = _relative(name[4:], *_levels(curves, name[4:], sign > 0), bound)
        return Rows(np.full(len(values), LIMIT), sign * values + _INSIDE, sign * rates * slopes)


def _levels(curves: Curves, quantity: str, every: bool) -> tuple[Array, Array]:
    """The located peak and, where a largest value is to be kept down, what all poses have."""
    value, slope = curves.peak(quantity)
    if not every or quantity not in CURVES:
        return np.array([value]), slope[None]
    values, slopes = curves.along(quantity)
    return np.append(values, value), np.concatenate([slopes, slope[None]])


def _relative(quantity: str, values: Array, slopes: Array, unit: float) -> tuple[Array, Array]:
    """Values (m,) and slopes (m, n) of a quantity over a unit: by its logarithm, small values by themselves.

    A margin is 1 less a strain over what is permissible: it is that which goes with powers of the design's numbers.
    """
    if quantity.endswith("margin"):
        values, slopes = _relative("", 1 - values, -slopes, 1 - unit)
        return -values, -slopes
    if unit <= 0:
        return (values - unit) / (abs(unit) or 1.0), slopes / (abs(unit) or 1.0)
    share = values / unit
    small = share < _SMALL
    steep = 1 / np.where(small, _SMALL, share)
    logs = np.log(np.where(small, _SMALL, share)) + np.where(small, share / _SMALL - 1, 0.0)
    return logs, slopes / unit * steep[:, None]
