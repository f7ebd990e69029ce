"""Free numbers on one scale: each from 0 to 1 between its bounds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array

_WIDE = 1.2  # the larger bound over the smaller: from there on a number counts by ratios


@dataclass(frozen=True, eq=False)
class Scale:
    """Free numbers and their bounds.

    A number whose bounds are positive counts by its logarithm: forces and strains go with powers of thicknesses,
    lengths and small angles, so that a straight line in logarithms foretells them farther than one in the numbers.

    Parameters
    ----------
    keys
        Of the numbers.
    low, high
        Their bounds (n,), in SI units.
    """

    keys: tuple[str, ...]
    low: Array
    high: Array

    @classmethod
    def of(cls, bounds: Mapping[str, tuple[float, float]]) -> Scale:
        """The scale of numbers between bounds, by key."""
        low, high = np.array(list(bounds.values()), dtype=float).T
        return cls(tuple(bounds), low, high)

    @property
    def _ratio(self) -> Array:
        """Which numbers count by their logarithm (n,)."""
        found: Array = (self.low > 0) & (self.high > _WIDE * self.low)
        return found

    def values(self, x: Array) -> Array:
        """Numbers (n,) of a design x (n,), in SI units."""
        inside = np.clip(x, 0.0, 1.0)
        even = self.low + (self.high - self.low) * inside
        with np.errstate(invalid="ignore", divide="ignore"):
            steep = self.low * np.exp(np.log(self.high / self.low) * inside)
        return np.clip(np.where(self._ratio, steep, even), self.low, self.high)

    def place(self, values: Array) -> Array:
        """Design x (n,) of numbers, the nearest within the bounds."""
        inside = np.clip(values, self.low, self.high)
        with np.errstate(invalid="ignore", divide="ignore"):
            steep = np.log(inside / self.low) / np.log(self.high / self.low)
        return np.where(self._ratio, steep, (inside - self.low) / (self.high - self.low))

    def slopes(self, x: Array) -> Array:
        """Derivatives of the numbers by x (n,)."""
        with np.errstate(invalid="ignore", divide="ignore"):
            steep = self.values(x) * np.log(self.high / self.low)
        return np.where(self._ratio, steep, self.high - self.low)
