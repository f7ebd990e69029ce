"""A section of fibres: energy per length, moment and axial force by the curvature and the axis' stretch.

With k = kappa w and the fibres at y = eta w, abs(eta) <= 1/2, energy per length over EA is

    phi(k, e) = < W(e - k (1 - nu e) eta) > + c k^4 / (1 + 48 abs(c) k^2),
    240 c = b - nu^2 / 6 - 2 a nu / 3 - (1 - nu^2),

< > the mean over the thickness, a and b the law's second order (:meth:`gripper.laws.Fibre.begins`). This is the plane
problem of a bent strip, minimise over the place r of the fibres < W(kappa r, r') >, to the fourth order in k:

- a stretched section is thinner: 1 - nu e;
- so is the stretched half of a bent one, and the other thicker, which brings the fibres nearer to the outer side or
  takes them from it: b - nu^2 / 6 - 2 a nu / 3;
- fibres press on each other towards the inner side, sigma_r' = kappa sigma, and give way: 1 - nu^2.

The denominator only keeps the term small against the first where a finger is rolled up.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array
from gripper.laws.fibres import Fibre, Logarithmic, NeoHookean, StVenantKirchhoff

if TYPE_CHECKING:
    from gripper.fingers import Material

Phi = tuple[Array, Array, Array, Array, Array, Array]
"""phi, its derivatives by k and e, and the second ones: kk, ke, ee."""
_CONDENSING = 20  # steps of Newton's
_BALANCED = 1e-9  # of EA: the next step, of second order, is round-off


@functools.cache
def gauss(points: int) -> tuple[Array, Array]:
    """Places eta over the thickness, and their weights."""
    x, weights = np.polynomial.legendre.leggauss(points)
    return x / 2, weights / 2


@dataclass(frozen=True)
class SectionLaw:
    """Fibres across a section.

    Parameters
    ----------
    fibre
        Their law.
    ratio
        nu of the plane: nu / (1 - nu) in plane strain.
    """

    fibre: Fibre
    ratio: float

    def phi(self, k: Array, e: Array) -> Phi:
        """Energy per length over EA, with its derivatives, each of the shape of k."""
        eta, weights = gauss(self.fibre.POINTS)
        bend, stretch = self.mixing(k, e)
        energy, stress, modulus = self.fibre.answer(e[:, None] + k[:, None] * bend)
        first = energy @ weights, (stress * bend) @ weights, (stress * stretch) @ weights
        both = modulus * bend * stretch + stress * (self.ratio * eta)
        second = (modulus * bend**2) @ weights, both @ weights, (modulus * stretch**2) @ weights
        more, slope, curvature = self._across(k)
        return first[0] + more, first[1] + slope, first[2], second[0] + curvature, second[1], second[2]

    def mixing(self, k: Array, e: Array) -> tuple[Array, Array]:
        """Derivatives of the fibres' strains by k and e: (n, fibres) each; the strains are e + k times the first."""
        eta, _ = gauss(self.fibre.POINTS)
        return -(1 - self.ratio * e[:, None]) * eta, 1 + self.ratio * k[:, None] * eta

    @functools.cached_property
    def fourth(self) -> float:
        """The coefficient c."""
        a, b = self.fibre.begins(self.ratio)
        nu = self.ratio
        return (b - nu**2 / 6 - 2 * a * nu / 3 - (1 - nu**2)) / 240

    def _across(self, k: Array) -> tuple[Array, Array, Array]:
        """What the directions across add: value, slope and curvature by k."""
        c, s = self.fourth, 48 * abs(self.fourth)
        below = 1 + s * k**2
        value = c * k**4 / below
        slope = (4 * c * k**3 - 2 * s * k * value) / below
        return value, slope, (12 * c * k**2 - 2 * s * value - 4 * s * k * slope) / below

    def bent(self, k: Array) -> tuple[Array, Array, Array, Array]:
        """Energy, its slope and curvature by k, and e, where no axial force acts: d phi / de = 0."""
        e = np.zeros_like(k)
        for _ in range(_CONDENSING):
            *_, axial, _, _, stiff = self.phi(k, e)
            e = e - axial / stiff
            if np.max(np.abs(axial), initial=0.0) < _BALANCED:
                break
        value, slope, _, kk, ke, ee = self.phi(k, e)
        return value, slope, kk - ke**2 / ee, e

    def strains(self, k: Array, e: Array) -> tuple[Array, Array]:
        """Strain of the two outer fibres: upper and lower."""
        half = k * (1 - self.ratio * e) / 2
        return e - half, e + half


@functools.lru_cache(maxsize=64)
def section_law(material: Material) -> SectionLaw | None:
    """The section law of a material; None for the linear one."""
    nu, strain = material.poisson_ratio, material.plane == "strain"
    ratio = nu / (1 - nu) if strain else nu
    if material.law == "linear":
        return None
    if material.law == "secant":
        from gripper.laws.secant import Secant  # here: the interpolation is imported where it is needed

        return SectionLaw(Secant(material.youngs_modulus, material.table or ()), ratio)
    if material.law == "neo_hookean":
        return SectionLaw(NeoHookean(nu, 1 if strain else 2), ratio)
    return SectionLaw({"logarithmic": Logarithmic, "st_venant_kirchhoff": StVenantKirchhoff}[material.law](), ratio)
