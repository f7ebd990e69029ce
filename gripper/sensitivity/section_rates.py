"""What a finger's sections answer to given strains, and how it changes along the finger and with its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array
from gripper.laws import Response
from gripper.laws.rates import LawRates
from gripper.sensitivity.finger_rates import FingerRates

_POISSON = "material.poisson_ratio"


@dataclass(frozen=True, eq=False)
class Answered:
    """Stresses (fields, k) and energy per length (k,) at stations, strains and places by L held.

    Slopes are those along the finger, by sigma; rates (p, ...) those by the finger's numbers.
    """

    stress: Array
    stress_slopes: Array
    stress_rates: Array
    density: Array
    density_slopes: Array
    density_rates: Array
    stiffness: Array
    """Of each field, under the linear law."""


def answered(finger: FingerRates, sigma: Array, strains: Array) -> Answered:
    """What the sections at stations sigma (k,) answer to strains (fields, k)."""
    law = finger.sections.law
    if law is not None:
        return Sectioned(finger, sigma, len(strains)).answered(strains)
    table = finger.stiffness(sigma, len(strains))
    stresses = [values * strains for values in table]
    densities = [(values * strains**2).sum(axis=-2) / 2 for values in table]
    return Answered(stresses[0], stresses[1], stresses[2], densities[0], densities[1], densities[2], table[0])


class Sectioned:
    """Sections with a law of their own at some stations: W(kappa, gamma, eps) by what it is made of.

    Directions are the slope along the finger, then the finger's numbers: the leading axis, (1 + p).
    """

    def __init__(self, finger: FingerRates, sigma: Array, fields: int) -> None:
        law = finger.sections.law
        if law is None:
            raise ValueError("the material must have a law of its own; got the linear one")
        self.law, self.finger = law, finger
        self.numbers = LawRates(law, finger.sections.finger.material, finger.keys)
        self.response = Response(law, finger.sections, sigma, fields)
        values, slopes, rates = finger.stiffness(sigma, 3)
        self.EI, self.GA, self.EA = values
        self.d_EI, self.d_GA, self.d_EA = np.concatenate([slopes[None], rates]).swapaxes(0, 1)
        self.w, self.steep, bend = (np.broadcast_to(v, sigma.shape) for v in finger.sections.profile(sigma))
        thick, steeper = finger.thickness(sigma)
        self.d_w = np.concatenate([self.steep[None], thick])
        self.d_steep = np.concatenate([bend[None], steeper])

    def phi_rates(self, k: Array, e: Array) -> Array:
        """Rates of phi, phi_k and phi_e at fixed k and e by each direction: (1 + p, 3, stations)."""
        own = self.numbers.phi(k, e)
        return np.concatenate([np.zeros((1, *own.shape[1:])), own])

    def answered(self, strains: Array) -> Answered:
        """Stresses and energy with their rates."""
        stress, density = np.zeros((len(self.d_w), *strains.shape)), np.zeros((len(self.d_w), strains.shape[1]))
        self._bent(strains, stress, density)
        if self.response.taper is not None:
            stiffer = self._sheared()
            stress[:, :2] += np.einsum("dijk,jk->dik", stiffer, strains[:2])
            density += np.einsum("ik,dijk,jk->dk", strains[:2], stiffer, strains[:2]) / 2
        whole = self.response.stress(strains), self.response.energy(strains)
        return Answered(whole[0], stress[0], stress[1:], whole[1], density[0], density[1:], np.zeros(0))

    def _bent(self, strains: Array, stress: Array, density: Array) -> None:
        """Write what bending and stretch change: EA phi(kappa w, e); without stretch e gives way, phi_e = 0."""
        k, stretches = strains[0] * self.w, len(strains) == 3
        e = strains[2] if stretches else self.law.bent(k)[3]
        phi, by_k, by_e, kk, ke, ee = self.law.phi(k, e)
        own = self.phi_rates(k, e)
        thicker = strains[0] * self.d_w
        bending, pulling = kk * thicker + own[:, 1], ke * thicker + own[:, 2]
        if not stretches:
            bending = bending - ke / ee * pulling
        density += self.d_EA * phi + self.EA * (by_k * thicker + own[:, 0])
        stress[:, 0] += (self.d_EA * self.w + self.EA * self.d_w) * by_k + self.EA * self.w * bending
        if stretches:
            stress[:, 2] += self.d_EA * by_e + self.EA * pulling

    def _sheared(self) -> Array:
        """Rates of the stiffness against kappa and gamma without bending's own, (1 + p, 2, 2, k): GA, and the taper."""
        whole = np.zeros((2, 2, self.w.size))
        whole[0, 0], whole[1, 1] = self.EI, self.GA
        whole += np.asarray(self.response.taper)
        out = -np.einsum("ijk,djlk,lmk->dimk", whole, self._compliances(), whole)
        out[:, 0, 0] -= self.d_EI
        return out

    def _compliances(self) -> Array:
        """Rates of the compliance of a tapered section (:mod:`gripper.laws.response`), (1 + p, 2, 2, k)."""
        material = self.finger.sections.finger.material
        coefficient, slope = material.shear_coefficient, 5 / (6 + 5 * material.poisson_ratio) ** 2
        d_coefficient = np.array([0.0, *(slope * (key == _POISSON) for key in self.finger.keys)])[:, None]
        steep, moving = self.response.steep
        d_steep = (moving * self.d_steep - steep * self.d_w) / self.w
        area = self.GA / coefficient
        d_area = (self.d_GA - area * d_coefficient) / coefficient
        out = np.zeros((len(self.d_w), 2, 2, self.w.size))
        thinner = d_area / area
        out[:, 0, 0] = -self.d_EI / self.EI**2 + 1.8 / area * steep * (2 * d_steep - steep * thinner)
        out[:, 0, 1] = out[:, 1, 0] = 0.6 / area * (d_steep - steep * thinner)
        out[:, 1, 1] = -self.d_GA / self.GA**2
        return out

    def strain(
        self,
        strains: Array,
        moment: tuple[Array, Array],
        axial: tuple[Array, Array],
        total: Callable[[Array], Array],
    ) -> tuple[Array, Array]:
        """Largest strain of one section under M and N, and its rates (p,).

        Parameters
        ----------
        strains
            Near to it, (fields, 1).
        moment, axial
            M and N, and their rates (p,).
        total
            Makes rates by all numbers (p,) of those by this section's directions (1 + p', 1), as it moves.
        """
        k, e = self.response.held(strains, np.array([moment[0]]), np.array([axial[0]]))
        _, by_k, by_e, kk, ke, ee = self.law.phi(k, e)
        own = self.phi_rates(k, e)
        stiffer = total(self.d_EA) / self.EA
        thicker = total(self.d_w) / self.w
        off = moment[1] / (self.EA * self.w) - by_k * (stiffer + thicker) - total(own[:, 1])
        apart = axial[1] / self.EA - by_e * stiffer - total(own[:, 2])
        whole = kk * ee - ke**2
        rates = np.sign(e) * (kk * apart - ke * off) / whole + np.sign(k) / 2 * (ee * off - ke * apart) / whole
        return np.abs(e[0]) + np.abs(k[0]) / 2, rates
