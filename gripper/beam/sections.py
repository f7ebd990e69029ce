"""The finger's sections along its length, dimensionless: lengths by L, stiffnesses by EI(0) and L."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy

from gripper.arrays import Array
from gripper.beam.grading import graded
from gripper.beam.rest import Rest, rest
from gripper.fingers import Finger, S
from gripper.interval import NoEnclosureError, enclose_all
from gripper.kinks import beside_kinks
from gripper.laws import SectionLaw, section_law

_PARTS = 16
_BESIDE = 1e-9  # of L: how far beside a kink
_JUMP = 1e-5  # relative: across a kink the thickness is continuous where it changes by less
_CHECKED = np.linspace(0.0, 1.0, 129)


def _compiled(*expressions: sympy.Expr) -> Callable[[Array], tuple[Array, ...]]:
    """Expressions in s as one function of an array: one array each, also where an expression is constant."""
    function = sympy.lambdify([S], list(expressions), "numpy", cse=True)

    def evaluate(s: Array) -> tuple[Array, ...]:
        return tuple([v if isinstance(v, np.ndarray) else np.full(s.shape, float(v)) for v in function(s)])

    return evaluate


@dataclass(frozen=True, eq=False)
class Sections:
    """Thickness and stiffness of a finger over sigma = s / L in [0, 1].

    Forces are scaled by EI(0) / L^2, moments and energy by EI(0) / L, lengths by L.
    """

    finger: Finger
    length: float
    bending_stiffness: float
    kinks: tuple[float, ...]
    rest: Rest | None
    """The shape of the unloaded axis; None where it is straight."""
    base: float | None
    """Rotational stiffness of what holds it, times L over EI(0); None where that is rigid."""
    thickness_bounds: tuple[float, float, float]
    """Upper bounds of w / L, abs(dw/ds), L abs(d2w/ds2), proved by interval arithmetic (infinite where it cannot)."""
    law: SectionLaw | None
    """What a section answers; None under the linear law."""
    _thickness: Callable[[Array], tuple[Array, ...]]
    _stiffness: Callable[[Array], tuple[Array, ...]]
    _profile: Callable[[Array], tuple[Array | float, ...]]

    @property
    def force_scale(self) -> float:
        """EI(0) / L^2, in N."""
        return self.bending_stiffness / self.length**2

    @property
    def energy_scale(self) -> float:
        """EI(0) / L, in J (and N m)."""
        return self.bending_stiffness / self.length

    @functools.cached_property
    def cuts(self) -> tuple[float, ...]:
        """Where segments end: at kinks, and where the stiffness varies too much for one polynomial."""
        marks = (0.0, *self.kinks, 1.0)
        return tuple(sorted({*self.kinks, *graded(lambda sigma: 1 / self.EI(sigma), marks)}))

    @functools.cached_property
    def _moduli(self) -> tuple[float, float, float]:
        """What b w^3, b w and b w, in SI, are multiplied by: EI over EI(0), kappa_s GA and EA times L^2 over EI(0)."""
        material = self.finger.material
        moduli = material.bending_modulus / 12, material.shear_coefficient * material.G, material.bending_modulus
        bending, shear, stretch = (modulus / self.bending_stiffness for modulus in moduli)
        return bending, shear * self.length**2, stretch * self.length**2

    def thickness(self, sigma: Array) -> Array:
        """w / L."""
        return self._thickness(sigma * self.length)[0] / self.length

    def profile(self, sigma: Array) -> tuple[Array | float, ...]:
        """w / L, dw/ds and L d2w/ds2; a constant is one number."""
        w, slope, curvature = self._profile(sigma * self.length)
        return w / self.length, slope, curvature * self.length

    def stiffness(self, sigma: Array) -> tuple[Array, Array, Array]:
        """EI over EI(0), and GA and EA as below."""
        second, area = self._stiffness(sigma * self.length)
        bending, shear, stretch = self._moduli
        return second * bending, area * shear, area * stretch

    def EI(self, sigma: Array) -> Array:
        """Bending stiffness over EI(0): E b w^3 / 12."""
        return self.stiffness(sigma)[0]

    def GA(self, sigma: Array) -> Array:
        """Shear stiffness times L^2 over EI(0), Kaneko's coefficient included: kappa_s G b w."""
        return self.stiffness(sigma)[1]

    def EA(self, sigma: Array) -> Array:
        """Axial stiffness times L^2 over EI(0): E b w, with E / (1 - nu^2) in plane strain as EI has it."""
        return self.stiffness(sigma)[2]


@functools.lru_cache(maxsize=256)
def _profile(w: sympy.Expr, b: sympy.Expr) -> tuple[Callable[[Array], tuple[Any, ...]], ...]:
    """Thickness, width, stiffness, and the thickness with its derivatives: compiled once for all fingers with them."""
    profile = sympy.lambdify([S], [w, sympy.diff(w, S), beside_kinks(sympy.diff(w, S, 2))], "numpy", cse=True)
    return _compiled(w), _compiled(b), _compiled(b * w**3, b * w), profile


@functools.lru_cache(maxsize=256)
def sections(finger: Finger) -> Sections:
    """Compile a finger's profile (once a finger).

    Raises
    ------
    ValueError
        Where the thickness or the width is not positive and finite somewhere on [0, L], the thickness jumps (a step is
        a steep flank), or the rest shape folds.
    """
    w, b = sympy.sympify(finger.w(S)), sympy.sympify(finger.b(S))
    thickness, width, stiffness, profile = _profile(w, b)
    _check_positive("thickness", thickness, finger.length)
    _check_positive("width", width, finger.length)
    torn = largest_jump(finger, lambda s: thickness(s)[0])
    if torn:
        raise ValueError(f"thickness must be continuous, in m; got a jump of {torn[1]!r} at s = {torn[0]!r}")
    clamp = np.zeros(1)
    scale = finger.material.bending_modulus * float(stiffness(clamp)[0][0]) / 12
    kinks = tuple(sorted(k / finger.length for k in finger.kinks()))
    bounds = _bounds(w, finger.length)
    bent = None if finger.rest_curvature is None else rest(finger.rest_curvature, finger.length, kinks)
    if bent is not None:
        folded = bent.bounds[0] * bounds[0] / 2
        if folded >= 1:
            raise ValueError(f"rest_curvature times half the thickness must stay below 1; got up to {folded:.3g}")
        kinks = tuple(sorted({*kinks, *bent.kinks}))
    law = section_law(finger.material)
    base = None if finger.base is None else finger.base.rotational_stiffness * finger.length / scale
    return Sections(finger, finger.length, scale, kinks, bent, base, bounds, law, thickness, stiffness, profile)


def largest_jump(finger: Finger, thickness: Callable[[Array], Array]) -> tuple[float, float] | None:
    """Where a finger's thickness jumps most at one of its kinks, and by how much, in m; None where it is continuous."""
    kinks = np.array(finger.kinks())
    if not kinks.size:
        return None
    before, after = thickness(kinks - _BESIDE * finger.length), thickness(kinks + _BESIDE * finger.length)
    jumps = np.abs(after - before)
    worst = int(np.argmax(jumps))
    return (float(kinks[worst]), float(jumps[worst])) if jumps[worst] > _JUMP * before[worst] else None


def check_width(finger: Finger) -> None:
    """Refuse a width that is not positive and finite somewhere on [0, L], without a look at the profile."""
    _check_positive("width", _compiled(sympy.sympify(finger.b(S))), finger.length)


def _check_positive(name: str, function: Callable[[Array], Any], length: float) -> None:
    stations = _CHECKED * length
    with np.errstate(all="ignore"):
        values: Any = function(stations)[0]
    wrong = ~(np.isfinite(values) & (values > 0))
    if wrong.any():
        value, place = float(values[wrong][0]), float(stations[wrong][0])
        raise ValueError(f"{name} must be positive along the finger, in m; got {value!r} at s = {place!r}")


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
