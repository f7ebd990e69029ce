"""A fibre that follows a measured curve: the secant modulus E_s = stress / strain of each strain is the curve's own."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

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
        slopes = PchipInterpolator(strain, stress).derivative()(strain)
        slopes[strain == 0] = 1.0
        curve = CubicHermiteSpline(strain, stress, slopes)
        whole = curve.antiderivative()
        whole.c[-1] -= whole(0.0)
        return whole, curve, curve.derivative()

    def known(self, strain: Array) -> Answer:
        """As the base says."""
        energy, stress, modulus = (curve(strain) for curve in self._curves)
        return energy, stress, modulus


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
