"""What a section law answers along a finger: energy per length W(kappa, gamma, eps), stresses, stiffness, by L.

In a tapered section the stress along the faces carries a part of the shear force. Of the stresses
sigma = M y / I and their equilibrium with faces of slope +- w'/2 (no more), tau is

    tau b w = 3 m + (q - 3 m) 3/2 (1 - 4 y^2 / w^2),     q = dM/ds = -Q,   m = M w' / w,

and its energy, int tau^2 / 2G, is (6/5 q^2 - 6/5 q m + 9/5 m^2) / (2 G b w): the section's compliance to M and Q gets
two terms more (Balduzzi, Aminbaghai, Sacco, Fuessl, Eberhardsteiner & Auricchio 2016, Int. J. Solids Struct. 90, for
any profile). 6/5 q^2 is what the shear coefficient stands for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array
from gripper.laws.section import Phi, SectionLaw

if TYPE_CHECKING:
    from gripper.beam.sections import Sections

Tensor = Array
"""(fields, fields, k)."""
_STEEPEST = 0.3  # dw/ds beyond which a face is a step's flank, along which no stress turns
_NEWTON = 12


class Response:
    """A section law at some stations.

    Parameters
    ----------
    law
        Of the section.
    sections
        Gives stiffness and thickness.
    sigma
        Stations s / L, (k,).
    fields
        How many strains there are: 1 in bending, 2 with shear, 3 with stretch.
    """

    def __init__(self, law: SectionLaw, sections: Sections, sigma: Array, fields: int) -> None:
        self.law, self.fields = law, fields
        self.w, self.slope, _ = (np.broadcast_to(v, sigma.shape) for v in sections.profile(sigma))
        EI, self.GA, self.EA = sections.stiffness(sigma)
        self.taper = self._taper(EI, sections.finger.material.shear_coefficient) if fields > 1 else None

    @property
    def steep(self) -> tuple[Array, Array]:
        """w' / w as a taper counts, (k,), and whether it counts as it is: on a step's flank it stays as it is."""
        return np.clip(self.slope, -_STEEPEST, _STEEPEST) / self.w, np.abs(self.slope) < _STEEPEST

    def _taper(self, EI: Array, coefficient: float) -> Tensor:
        """What a taper adds to the stiffness against kappa and gamma, (2, 2, k)."""
        steep, area = self.steep[0], self.GA / coefficient
        bending, mixed, shear = 1 / EI + 1.8 * steep**2 / area, 0.6 * steep / area, 1 / self.GA
        whole = bending * shear - mixed**2
        return np.array([[shear / whole - EI, -mixed / whole], [-mixed / whole, bending / whole - self.GA]])

    def energy(self, strains: Array) -> Array:
        """W (k,) of strains (fields, k): kappa, gamma, eps."""
        energy: Array = self.EA * self._bending(strains)[0]
        if self.taper is not None:
            energy += self.GA * strains[1] ** 2 / 2
            energy += np.einsum("ik,ijk,jk->k", strains[:2], self.taper, strains[:2]) / 2
        return energy

    def stress(self, strains: Array) -> Array:
        """M, Q and N (fields, k): the derivatives of W."""
        phi = self._bending(strains)
        out = np.zeros_like(strains)
        out[0] = self.EA * self.w * phi[1]
        if self.taper is not None:
            out[1] = self.GA * strains[1]
            out[:2] += np.einsum("ijk,jk->ik", self.taper, strains[:2])
        if self.fields == 3:
            out[2] = self.EA * phi[2]
        return out

    def stiffness(self, strains: Array) -> Tensor:
        """Second derivatives of W, (fields, fields, k)."""
        phi = self._bending(strains)
        out = np.zeros((self.fields, *strains.shape))
        out[0, 0] = self.EA * self.w**2 * phi[3]
        if self.taper is not None:
            out[1, 1] = self.GA
            out[:2, :2] += self.taper
        if self.fields == 3:
            out[0, 2] = out[2, 0] = self.EA * self.w * phi[4]
            out[2, 2] = self.EA * phi[5]
        return out

    def loaded(self, strains: Array, moment: Array, axial: Array) -> Array:
        """Largest abs(eps) + abs(kappa) w / 2 under M and N (k,), from strains near to it (fields, k)."""
        k, e = self.held(strains, moment, axial)
        largest: Array = np.abs(e) + np.abs(k) / 2
        return largest

    def held(self, strains: Array, moment: Array, axial: Array) -> tuple[Array, Array]:
        """Kappa w and eps under M and N (k,), by Newton's method from strains near to it (fields, k)."""
        k, e = strains[0] * self.w, strains[2] if self.fields == 3 else self.law.bent(strains[0] * self.w)[3]
        for _ in range(_NEWTON):
            _, slope, pull, kk, ke, ee = self.law.phi(k, e)
            off, apart = moment / (self.EA * self.w) - slope, axial / self.EA - pull
            whole = kk * ee - ke**2
            k, e = k + (ee * off - ke * apart) / whole, e + (kk * apart - ke * off) / whole
        return k, e

    def beyond(self, strains: Array) -> float | None:
        """The strain of the fibre that lies farthest beyond what the law knows; None where it knows them all."""
        k = strains[0] * self.w
        e = strains[2] if self.fields == 3 else self.law.bent(k)[3]
        outer = np.concatenate(self.law.strains(k, e))
        least, most = self.law.fibre.span
        past = np.maximum(least - outer, outer - most)
        worst = int(np.argmax(past))
        return float(outer[worst]) if past[worst] > 0 else None

    def _bending(self, strains: Array) -> Phi:
        """phi with its derivatives; without stretch the axial force is 0, and phi is of k alone."""
        k = strains[0] * self.w
        if self.fields == 3:
            return self.law.phi(k, strains[2])
        value, slope, curvature, _ = self.law.bent(k)
        none = np.zeros_like(k)
        return value, slope, none, curvature, none, none
