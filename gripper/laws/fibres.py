"""A fibre under uniaxial stress: energy, nominal stress and tangent modulus by its strain, over Young's modulus.

The strain is that of the axis, stretch - 1; the fibre contracts across as its law says, in plane strain only in the
plane. E is the modulus of bending (E / (1 - nu^2) in plane strain), and every law begins with slope 1.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gripper.arrays import Array

Answer = tuple[Array, Array, Array]
"""Energy per volume, nominal stress and tangent modulus, over E."""


class Fibre(ABC):
    """A law of uniaxial stress."""

    POINTS: ClassVar[int] = 12
    """Gauss' points over the thickness: as many as leave round-off at strains of 0.4."""

    @property
    @abstractmethod
    def span(self) -> tuple[float, float]:
        """The strains between which it is known. Beyond, it goes on with a constant modulus, for iterations to pass."""

    def begins(self, ratio: float) -> tuple[float, float]:
        """Second order at small strain: of stress = strain + a strain^2, and across, 1 - nu strain + b strain^2.

        Parameters
        ----------
        ratio
            nu of the plane, without unit.
        """
        return 0.0, 0.0

    def begins_rates(self, ratio: float, rate: float) -> tuple[float, float]:
        """Rates of both by nu, of which the plane's ratio has this one."""
        return 0.0, 0.0

    def by_numbers(self, strain: Array) -> dict[str, tuple[Array, Array]]:
        """Rates of energy and stress at strains within the span by the material's numbers, by their names."""
        return {}

    @abstractmethod
    def known(self, strain: Array) -> Answer:
        """The answer at strains within the span."""

    def answer(self, strain: Array) -> Answer:
        """Energy, stress and tangent modulus at any strain, arrays of its shape."""
        inside = np.clip(strain, *self.span)
        energy, stress, modulus = self.known(inside)
        beyond = strain - inside
        if not beyond.any():
            return energy, stress, modulus
        stiff = np.where(beyond == 0, modulus, np.maximum(modulus, _LEAST_MODULUS))
        return energy + beyond * (stress + stiff * beyond / 2), stress + stiff * beyond, stiff


_LEAST_MODULUS = 0.01  # of E: what a fibre beyond its law keeps


@dataclass(frozen=True)
class Logarithmic(Fibre):
    """W = ln(stretch)^2 / 2 (Hencky)."""

    @property
    def span(self) -> tuple[float, float]:
        """As the base says."""
        return -0.8, 1.5

    def begins(self, ratio: float) -> tuple[float, float]:
        """As the base says."""
        return -1.5, ratio * (1 + ratio) / 2

    def begins_rates(self, ratio: float, rate: float) -> tuple[float, float]:
        """As the base says."""
        return 0.0, rate * (1 + 2 * ratio) / 2

    def known(self, strain: Array) -> Answer:
        """As the base says."""
        stretch = 1 + strain
        log = np.log1p(strain)
        return log**2 / 2, log / stretch, (1 - log) / stretch**2


@dataclass(frozen=True)
class StVenantKirchhoff(Fibre):
    """W = (stretch^2 - 1)^2 / 8: Green's strain. In compression its modulus falls, to 0 at a stretch of 0.577."""

    @property
    def span(self) -> tuple[float, float]:
        """As the base says."""
        return -0.4, 2.0

    def begins(self, ratio: float) -> tuple[float, float]:
        """As the base says."""
        return 1.5, -ratio * (1 + ratio) / 2

    def begins_rates(self, ratio: float, rate: float) -> tuple[float, float]:
        """As the base says."""
        return 0.0, -rate * (1 + 2 * ratio) / 2

    def known(self, strain: Array) -> Answer:
        """As the base says."""
        green = strain + strain**2 / 2
        stretch = 1 + strain
        return green**2 / 2, stretch * green, green + stretch**2


@dataclass(frozen=True)
class NeoHookean(Fibre):
    """W = mu / 2 (I1 - 3 - 2 ln J) + lambda / 2 (ln J)^2, the directions across free of stress (one, in plane strain).

    Parameters
    ----------
    poisson_ratio
        nu, without unit.
    across
        How many directions contract: 2 in plane stress, 1 in plane strain.
    """

    poisson_ratio: float
    across: int = 2

    @property
    def span(self) -> tuple[float, float]:
        """As the base says."""
        return -0.8, 2.0

    def begins(self, ratio: float) -> tuple[float, float]:
        """As the base says."""
        first, second = self._contraction
        return -(second - first + 1) / (2 - first), second / 2 - first**2 / 8

    def begins_rates(self, ratio: float, rate: float) -> tuple[float, float]:
        """As the base says."""
        (first, second), (first_rate, second_rate) = self._contraction, self._contraction_rates
        steeper = (first_rate - second_rate - (second - first + 1) * first_rate / (2 - first)) / (2 - first)
        return steeper, second_rate / 2 - first * first_rate / 4

    @property
    def _contraction_rates(self) -> tuple[float, float]:
        """Rates of the first and second order of u, by nu."""
        nu, half = self.poisson_ratio, self.across / 2
        below, slope = 1 - 2 * nu * (1 - half), -2 * (1 - half)
        first, second = self._contraction
        first_rate = -2 / below**2
        return first_rate, (1 + half * first**2 + 2 * nu * half * first * first_rate - second * slope) / below

    def by_numbers(self, strain: Array) -> dict[str, tuple[Array, Array]]:
        """As the base says."""
        stretch, nu, half = 1 + strain, self.poisson_ratio, self.across / 2
        u = self._contracted(stretch)
        volume = np.log(stretch) + half * np.log(u)
        moving = 2 * (u - 1 - volume) / (1 - 2 * nu + 2 * nu * half / u)  # u, by nu
        energy, stress, _ = self.known(strain)
        unit, stiffer = 2 - self._contraction[0], -self._contraction_rates[0]
        squeezed = (half - half / u - volume / 2 - half * (u - 1) / (2 * u)) * moving
        return {"poisson_ratio": ((squeezed - stiffer * energy) / unit, (-moving / stretch - stiffer * stress) / unit)}

    @property
    def _contraction(self) -> tuple[float, float]:
        """First and second order of u in the strain."""
        nu, half = self.poisson_ratio, self.across / 2
        below = 1 - 2 * nu * (1 - half)
        first = -2 * nu / below
        return first, nu * (1 + half * first**2) / below

    def known(self, strain: Array) -> Answer:
        """As the base says; u is the square of the stretch across."""
        stretch, nu, half = 1 + strain, self.poisson_ratio, self.across / 2
        u = self._contracted(stretch)
        volume = np.log(stretch) + half * np.log(u)
        slope = -2 * nu / stretch / (1 - 2 * nu + 2 * nu * half / u)
        energy = (stretch**2 - 1) / 2 + half * (u - 1) - volume - (u - 1) * volume / 2
        stress, modulus = stretch - u / stretch, 1 + u / stretch**2 - slope / stretch
        unit = 2 - self._contraction[0]  # the modulus at no strain
        return energy / unit, stress / unit, modulus / unit

    def _contracted(self, stretch: Array) -> Array:
        """Where no stress is left across: (1 - 2 nu)(u - 1) + 2 nu (ln stretch + across / 2 ln u) = 0, by Newton."""
        nu, half = self.poisson_ratio, self.across / 2
        log = np.zeros_like(stretch)  # ln u
        for _ in range(_NEWTON):
            u = np.exp(log)
            left = (1 - 2 * nu) * (u - 1) + 2 * nu * (np.log(stretch) + half * log)
            log = log - left / ((1 - 2 * nu) * u + 2 * nu * half)
        return np.exp(log)


_NEWTON = 8
