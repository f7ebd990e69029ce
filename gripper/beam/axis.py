"""The deflected axis r(s) as a complex number x + iy, and the direction r' that the strains give it.

Inextensible (Lan & Lee eq 2, corrected):    r' = exp(i psi) exp(i gamma), gamma = 0 in bending;
with stretch (Simo 1985, after Reissner):    r' = exp(i psi) (1 + eps + i gamma).
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.series import Series
from gripper.beam.strains import Beam


@dataclass(frozen=True, eq=False)
class Course:
    """r' at some stations with its derivatives: along the axis, and by the strains there."""

    along: Complex  # r', (k,)
    bend: Complex  # r'', (k,)
    by_shear: Complex  # dr'/dgamma, (k,)
    by_stretch: Complex | None  # dr'/deps, (k,); None where the axis has none


@dataclass(frozen=True, eq=False)
class Axis:
    """A deflected axis: r' at the beam's Gauss points."""

    beam: Beam
    z: Array
    section: Complex  # exp(i psi) with stretch, r' without
    direction: Complex  # r'

    @classmethod
    def of(cls, beam: Beam, z: Array) -> Axis:
        """The axis of these unknowns."""
        turned = np.exp(1j * (beam.theta_map @ z + beam.rest_angle))
        if not beam.stretches:
            return cls(beam, z, turned, turned)
        gamma, eps = beam.strain_maps @ z
        return cls(beam, z, turned, turned * (1 + eps + 1j * gamma))

    def integrated(self, weights: Array) -> tuple[Complex, Complex]:
        """Positions (k,) and their gradients (k, n): r' and dr'/dz at the Gauss points under weights (k, g)."""
        found: Complex = (weights @ self._moving).view(complex)
        return found[:, 0], found[:, 1:]

    @property
    def turning(self) -> Complex:
        """dr'/dz at the Gauss points, (g, n)."""
        moving: Complex = self._moving.view(complex)
        return moving[:, 1:]

    @functools.cached_property
    def _moving(self) -> Array:
        """r' and dr'/dz side by side as real and imaginary parts, (g, 2 + 2 n): one product integrates both."""
        moving = np.empty((self.direction.size, self.beam.size + 1), dtype=complex)
        moving[:, 0] = self.direction
        np.multiply((1j * self.direction)[:, None], self.beam.theta_map, out=moving[:, 1:])
        if self.beam.stretches:
            by_shear, by_stretch = self.beam.strain_maps
            moving[:, 1:] += self.section[:, None] * (by_stretch + 1j * by_shear)
        return moving.view(float)

    def second_derivative(self, forces: Complex) -> Array:
        """sum_g f_g . d2r'_g/dz2, (n, n), for vectors f (g,) at the Gauss points."""
        map_, back = self.beam.theta_map, forces.conj()
        hessian: Array = map_.T @ (-(back * self.direction).real[:, None] * map_)
        if self.beam.stretches:
            by_shear, by_stretch = self.beam.strain_maps
            turned = (back * self.section)[:, None]
            mixed = map_.T @ (-turned.imag * by_stretch - turned.real * by_shear)
            hessian += mixed + mixed.T
        return hessian

    @functools.cached_property
    def fields(self) -> Array:
        """The strain fields' coefficients, (fields, segments, p + 1)."""
        return self.beam.coefficients(self.z)

    @functools.cached_property
    def _series(self) -> Series:
        return Series(self.beam, self.fields, self.direction, self.beam.base_turn(self.z))

    def values(self, s: Array, segment: Index) -> tuple[Complex, Array, Complex, Array]:
        """Position x + iy, psi, r' and kappa (k,) at stations s (k,) of given segments (k,).

        Kappa is the strain: psi' less the curvature at rest.
        """
        return self._values(self._series.read(s, segment), s)

    def evenly(self, count: int) -> tuple[Array, Complex, Array, Complex, Array]:
        """Stations (segments * count,) at even distances from end to end of each segment, and :meth:`values` there."""
        steps = np.linspace(0.0, 1.0, count)
        s = (self.beam.starts[:, None] + self.beam.lengths[:, None] * steps).ravel()
        return s, *self._values(self._series.read_evenly(count), s)

    def _values(self, read: Array, s: Array) -> tuple[Complex, Array, Complex, Array]:
        x, y, psi, kappa, *strains = read.T
        if self.beam.sections.rest is not None:
            psi = psi + self.beam.sections.rest.angle(s)
        if len(strains) == 2:
            gamma, eps = strains
            return x + 1j * y, psi, np.exp(1j * psi) * (1 + eps + 1j * gamma), kappa
        return x + 1j * y, psi, np.exp(1j * (psi + strains[0] if strains else psi)), kappa


def course(turn: Complex, strains: Sequence[Array]) -> Course:
    """Direction of the axis where the section has turned by exp(i psi): r' and its derivatives.

    Parameters
    ----------
    turn
        exp(i psi), (k,).
    strains
        gamma, psi', psi'', gamma' and, with stretch, eps and eps', (k,) each.
    """
    if len(strains) == 4:
        gamma, kappa, _, gamma1 = strains
        along = turn * np.exp(1j * gamma)
        sheared = 1j * along
        return Course(along, (kappa + gamma1) * sheared, sheared, None)
    gamma, kappa, _, gamma1, eps, eps1 = strains
    along = turn * (1 + eps + 1j * gamma)
    return Course(along, kappa * 1j * along + turn * (eps1 + 1j * gamma1), 1j * turn, turn)
