"""A fibre that follows a measured curve: the secant modulus E_s = stress / strain of each strain is the curve's own."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator, PPoly

from gripper.arrays import Array
from gripper.laws.fibres import Answer, Fibre

STEEPEST = 3.0
"""A monotone cubic may begin at most this many times as steep as its chord (Fritsch & Carlson 1980)."""
Table = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Secant(Fibre):
    """A monotone piecewise cubic (Fritsch & Carlson 1980) through points of stress over strain, of slope E at 0.

    Parameters
    ----------
    youngs_modulus
        E, in Pa: the slope at no strain.
    table
        Nominal stress (Pa) at strains, both rising. Points above 0 alone: compression is taken to mirror tension.
    """

    youngs_modulus: float
    table: Table
    POINTS: ClassVar[int] = 32  # its modulus has kinks

    @functools.cached_property
    def points(self) -> Array:
        """Strains and stresses over E, (2, n): with the origin, on both sides."""
        points = np.array(sorted({*self.table, (0.0, 0.0)})).T
        if points[0, 0] == 0:
            points = np.concatenate([-points[:, :0:-1], points], axis=1)
        return points / np.array([[1.0], [self.youngs_modulus]])

    @property
    def span(self) -> tuple[float, float]:
        """The table's."""
        return float(self.points[0, 0]), float(self.points[0, -1])

    @functools.cached_property
    def _curves(self) -> tuple[CubicHermiteSpline, CubicHermiteSpline, CubicHermiteSpline]:
        strain, stress = self.points
        curve = CubicHermiteSpline(strain, stress, _slopes(strain, stress))
        whole = curve.antiderivative()
        whole.c[-1] -= whole(0.0)
        return whole, curve, curve.derivative()

    def known(self, strain: Array) -> Answer:
        """As the base says."""
        energy, stress, modulus = (curve(strain) for curve in self._curves)
        return energy, stress, modulus

    def by_numbers(self, strain: Array) -> dict[str, tuple[Array, Array]]:
        """As the base says: by E, and by the table's numbers."""
        names, whole, curve = self._rates
        energy, stress = np.moveaxis(whole(strain), -1, 0), np.moveaxis(curve(strain), -1, 0)
        return {name: (energy[i], stress[i]) for i, name in enumerate(names)}

    @functools.cached_property
    def _rates(self) -> tuple[tuple[str, ...], PPoly, PPoly]:
        """Names of the numbers, and rates of energy and stress by them over the strain: cubics between the points."""
        names, across, up = self._moving()
        strain, stress = self.points
        wide, rise = np.diff(strain), np.diff(stress)
        slopes, turning = _slopes(strain, stress), _turning(strain, stress, across, up)
        c1, steep = slopes[:-1], rise / wide
        widening = np.diff(across, axis=1)
        steepening = (np.diff(up, axis=1) - steep * widening) / wide
        c2, c3 = (3 * steep - 2 * c1 - slopes[1:]) / wide, (c1 + slopes[1:] - 2 * steep) / wide**2
        bend = (3 * steepening - 2 * turning[:, :-1] - turning[:, 1:] - c2 * widening) / wide
        twist = (turning[:, :-1] + turning[:, 1:] - 2 * steepening - 2 * c3 * wide * widening) / wide**2
        left = across[:, :-1]  # the points that the cubics start at move along the curve
        rates = [twist, bend - 3 * c3 * left, turning[:, :-1] - 2 * c2 * left, up[:, :-1] - c1 * left]
        curve = PPoly(np.moveaxis(np.array(rates), 1, -1), strain)
        whole = curve.antiderivative()
        whole.c[-1] -= whole(0.0)
        return names, whole, curve

    def _moving(self) -> tuple[tuple[str, ...], Array, Array]:
        """The numbers' names, and how the points' strains and stresses over E move with each, (numbers, n)."""
        strain, stress = self.points
        names = ["youngs_modulus"]
        across, up = [np.zeros(strain.size)], [-stress / self.youngs_modulus]
        for i, (place, height) in enumerate(self.table):
            if (place, height) == (0.0, 0.0):
                continue
            mirrored = min(self.table)[0] >= 0
            side = np.sign(strain) * (np.abs(strain) == place) if mirrored else 1.0 * (strain == place)
            names += [f"table[{i}][0]", f"table[{i}][1]"]
            across += [side, 0 * strain]
            up += [0 * strain, side / self.youngs_modulus]
        return tuple(names), np.array(across), np.array(up)


def _slopes(strain: Array, stress: Array) -> Array:
    """Slopes of the curve at its points (n,): 1 at no strain."""
    slopes: Array = PchipInterpolator(strain, stress).derivative()(strain)
    slopes[strain == 0] = 1.0
    return slopes


def _turning(strain: Array, stress: Array, across: Array, up: Array) -> Array:
    """Rates of these slopes (numbers, n) by those of the points' strains and stresses (numbers, n).

    Fritsch & Butland's weighted harmonic means of the neighbouring chords' slopes, of three points at the ends.
    """
    h, dh = np.diff(strain), np.diff(across, axis=1)
    m = np.diff(stress) / h
    dm = (np.diff(up, axis=1) - m * dh) / h
    out = np.zeros_like(across)
    if len(h) == 1:
        out[:] = dm
    else:
        first, second = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
        d_first, d_second = 2 * dh[:, 1:] + dh[:, :-1], dh[:, 1:] + 2 * dh[:, :-1]
        below = first / m[:-1] + second / m[1:]
        d_below = (d_first - first / m[:-1] * dm[:, :-1]) / m[:-1] + (d_second - second / m[1:] * dm[:, 1:]) / m[1:]
        out[:, 1:-1] = (d_first + d_second - (first + second) / below * d_below) / below
        for end, (i, j) in ((0, (0, 1)), (-1, (-1, -2))):
            wide = h[i] + h[j]
            slope = ((2 * h[i] + h[j]) * m[i] - h[i] * m[j]) / wide
            rates = (2 * dh[:, i] + dh[:, j]) * m[i] + (2 * h[i] + h[j]) * dm[:, i] - dh[:, i] * m[j] - h[i] * dm[:, j]
            out[:, end] = (rates - slope * (dh[:, i] + dh[:, j])) / wide if slope > 0 else 0.0
    out[:, strain == 0] = 0.0
    return out


def check_table(table: Table, youngs_modulus: float) -> None:
    """Refuse a table that is no rising curve through the origin.

    Raises
    ------
    ValueError
        With the rule.
    """
    if not isinstance(table, tuple) or not all(isinstance(pair, tuple) and len(pair) == 2 for pair in table):
        raise ValueError(f"table must hold pairs of a strain and its stress, in Pa; got {table!r}")
    points = sorted({*table, (0.0, 0.0)})
    for (strain, stress), (further, larger) in pairwise(points):
        if not (further > strain and larger > stress):
            got = f"({strain:g}, {stress:g}) and ({further:g}, {larger:g})"
            raise ValueError(f"table must rise from the origin, strains (without unit) and stresses in Pa; got {got}")
    if len(points) < 2:
        raise ValueError(f"table must hold a strain and its stress, in Pa; got {table!r}")
    origin = points.index((0.0, 0.0))
    for strain, stress in points[max(origin - 1, 0) : origin] + points[origin + 1 : origin + 2]:
        if youngs_modulus > STEEPEST * stress / strain:
            rule = f"be at most {STEEPEST:g} times the stress over strain of the table's first point, in Pa"
            raise ValueError(f"youngs_modulus must {rule}, {stress / strain:g}; got {youngs_modulus:g}")
    if points[0][0] <= -1:
        raise ValueError(f"table must hold strains above -1; got {points[0][0]:g}")
