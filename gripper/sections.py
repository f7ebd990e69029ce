"""The finger's sections along its length, dimensionless: lengths by L, stiffnesses by EI(0) and L."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy

from gripper.arrays import Array
from gripper.fingers import Finger, S
from gripper.interval import NoEnclosureError, enclose_all
from gripper.kinks import beside_kinks

_PARTS = 16
_CHECKED = np.linspace(0.0, 1.0, 129)


def _compiled(expression: sympy.Expr) -> Callable[[Array], Array]:
    function = sympy.lambdify([S], expression, "numpy", cse=True)
    return lambda s: np.broadcast_to(np.asarray(function(s), dtype=float), np.shape(s))


@dataclass(frozen=True, eq=False)
class Sections:
    """Thickness and stiffness of a finger over sigma = s / L in [0, 1].

    Forces are scaled by EI(0) / L^2, moments and energy by EI(0) / L, lengths by L.
    """

    finger: Finger
    length: float
    bending_stiffness: float
    kinks: tuple[float, ...]
    thickness_bounds: tuple[float, float, float]
    """Upper bounds of w / L, abs(dw/ds), L abs(d2w/ds2), proved by interval arithmetic (infinite where it cannot)."""
    _thickness: Callable[[Array], Array]
    _width: Callable[[Array], Array]
    _profile: Callable[[Array], tuple[Array | float, ...]]

    @property
    def force_scale(self) -> float:
        """EI(0) / L^2, in N."""
        return self.bending_stiffness / self.length**2

    @property
    def energy_scale(self) -> float:
        """EI(0) / L, in J (and N m)."""
        return self.bending_stiffness / self.length

    def thickness(self, sigma: Array) -> Array:
        """w / L."""
        return self._thickness(sigma * self.length) / self.length

    def profile(self, sigma: Array) -> tuple[Array | float, ...]:
        """w / L, dw/ds and L d2w/ds2; a constant is one number."""
        w, slope, curvature = self._profile(sigma * self.length)
        return w / self.length, slope, curvature * self.length

    def EI(self, sigma: Array) -> Array:
        """Bending stiffness over EI(0): E b w^3 / 12."""
        s = sigma * self.length
        modulus = self.finger.material.bending_modulus
        return modulus / 12 / self.bending_stiffness * self._width(s) * self._thickness(s) ** 3

    def GA(self, sigma: Array) -> Array:
        """Shear stiffness times L^2 over EI(0), Kaneko's coefficient included: kappa_s G b w."""
        s, material = sigma * self.length, self.finger.material
        rigidity = material.shear_coefficient * material.G * self._width(s) * self._thickness(s)
        return rigidity * self.length**2 / self.bending_stiffness


@functools.lru_cache(maxsize=256)
def sections(finger: Finger) -> Sections:
    """Compile a finger's profile (once a finger).

    Raises
    ------
    ValueError
        Where the thickness or the width is not positive and finite somewhere on [0, L].
    """
    w, b = sympy.sympify(finger.w(S)), sympy.sympify(finger.b(S))
    thickness, width = _compiled(w), _compiled(b)
    profile = sympy.lambdify([S], [w, sympy.diff(w, S), beside_kinks(sympy.diff(w, S, 2))], "numpy", cse=True)
    stations = _CHECKED * finger.length
    for name, function in (("thickness", thickness), ("width", width)):
        with np.errstate(all="ignore"):
            values: Any = function(stations)
        wrong = ~(np.isfinite(values) & (values > 0))
        if wrong.any():
            place = stations[wrong][0]
            raise ValueError(
                f"{name} must be positive along the finger, in m; got {values[wrong][0]!r} at s = {place!r}"
            )
    clamp = np.zeros(1)
    stiffness = finger.material.bending_modulus * float((width(clamp) * thickness(clamp) ** 3)[0]) / 12
    kinks = tuple(sorted(k / finger.length for k in finger.kinks()))
    return Sections(finger, finger.length, stiffness, kinks, _bounds(w, finger.length), thickness, width, profile)


def _bounds(w: sympy.Expr, length: float) -> tuple[float, float, float]:
    marks = np.linspace(0.0, length, _PARTS + 1)
    try:
        ranges = enclose_all(
            [beside_kinks(sympy.diff(w, S, order)) for order in range(3)], {S: (marks[:-1], marks[1:])}
        )
    except NoEnclosureError:
        return (np.inf,) * 3
    largest = [float(np.max(np.maximum(np.abs(low), np.abs(high)))) for low, high in ranges]
    return largest[0] / length, largest[1], largest[2] * length
