"""How a section law changes with its material's numbers: nu, and the points of a measured curve."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gripper.arrays import Array
from gripper.fingers import Material
from gripper.laws.section import SectionLaw, gauss

_POISSON = "material.poisson_ratio"


class LawRates:
    """Derivatives of a section law at fixed strains.

    Parameters
    ----------
    law
        Of the section.
    material
        Whose law it is.
    keys
        Numbers, p of them: ``material.poisson_ratio``, ``material.table[0][1]``; others have no part in it.
    """

    def __init__(self, law: SectionLaw, material: Material, keys: Sequence[str]) -> None:
        self.law, self.keys = law, tuple(keys)
        wide = material.plane == "strain"
        self.ratio_rate = 1 / (1 - material.poisson_ratio) ** 2 if wide else 1.0  # of the plane's ratio, by nu

    def phi(self, k: Array, e: Array) -> Array:
        """Rates of phi, phi_k and phi_e by each number, (p, 3, n)."""
        eta, weights = gauss(self.law.fibre.POINTS)
        bend, stretch = self.law.mixing(k, e)
        strain = e[:, None] + k[:, None] * bend
        out = np.zeros((len(self.keys), 3, k.size))
        for name, (energy, stress) in self.law.fibre.by_numbers(strain).items():
            key = f"material.{name}"
            if key in self.keys:
                parts = energy, stress * bend, stress * stretch
                out[self.keys.index(key)] += [part @ weights for part in parts]
        if _POISSON in self.keys:
            _, stress, modulus = self.law.fibre.answer(strain)
            shift = (k * e)[:, None] * eta  # of the strain, by the ratio
            own = stress * shift, modulus * bend * shift + stress * e[:, None] * eta
            pulled = modulus * stretch * shift + stress * k[:, None] * eta
            rates = np.array([part @ weights for part in (*own, pulled)]) * self.ratio_rate
            rates[:2] += self._across(k)
            out[self.keys.index(_POISSON)] += rates
        return out

    def _across(self, k: Array) -> tuple[Array, Array]:
        """Rates of what the directions across add to phi and phi_k, by nu."""
        law, nu = self.law, self.law.ratio
        a, _ = law.fibre.begins(nu)
        steeper, across = law.fibre.begins_rates(nu, self.ratio_rate)
        own = -nu / 3 * self.ratio_rate - 2 / 3 * (steeper * nu + a * self.ratio_rate) + 2 * nu * self.ratio_rate
        rate, c = (across + own) / 240, law.fourth
        below = 1 + 48 * abs(c) * k**2
        # c k^4 / (1 + 48 |c| k^2) by c, and the slope of that
        return rate * k**4 / below**2, rate * (4 * k**3 / below - 192 * abs(c) * k**5 / below**2) / below
