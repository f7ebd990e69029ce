"""What else loads a deflected finger, and how it changes with it and with the numbers of the scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.sensitivity.geometry import Bending, Geometry
from gripper.sensitivity.load_rates import LoadRate, LoadRates
from gripper.statics.acting import Acting, Sampled
from gripper.statics.equilibrium import Equilibrium

_NEAR = 12  # Gauss points between a section and the end of its segment


@dataclass(frozen=True, eq=False)
class Shift:
    """What numbers change for loads where the dimensionless finger stays: (d,) each."""

    turning: Array  # of the clamp
    parameter: Array
    log_length: Array
    log_force: Array
    log_energy: Array


@dataclass(frozen=True, eq=False)
class Moved:
    """Rates of what acts on sections of the axis: places, forces and couples, (d, k) each."""

    points: Complex
    forces: Complex
    couples: Array


class Bearing:
    """One load on sections at fixed places x of their segments.

    Parameters
    ----------
    rate
        Of the load.
    acting, equilibrium, geometry
        The loads at the equilibrium of this finger.
    x, segment
        Where the sections are, (k,).
    weights
        The length that each stands for, in m; None of a load on single sections.
    """

    def __init__(
        self,
        rate: LoadRate,
        acting: Acting,
        equilibrium: Equilibrium,
        geometry: Geometry,
        x: Array,
        segment: Index,
        weights: Array | None,
    ) -> None:
        beam = equilibrium.state.beam
        self._where = rate, acting, equilibrium, geometry
        self.rate, self.geometry, self.sections = rate, geometry, beam.sections
        self.s = beam.starts[segment] + beam.lengths[segment] * (x + 1) / 2
        self.x, self.segment = x, segment
        self.sampled = Sampled(rate.part, equilibrium.state.axis, acting.stage, self.s, segment, weights)
        self.marks = geometry.marks(x, segment)
        scales = self.sections
        self.units = 1 / scales.force_scale, 1 / scales.energy_scale
        felt = self.sampled.felt(self.units)
        self.points, self.forces, self.couples = felt.points, felt.forces, felt.couples
        self.by_s, self.by_numbers, self.energy_by_s, self.energy_by_numbers = rate.at(self.sampled)

    def at(self, x: Array, segment: Index, weights: Array) -> Bearing:
        """The same load on other sections."""
        return Bearing(*self._where, x, segment, weights)

    @property
    def spread_out(self) -> bool:
        """Whether it acts along the whole axis."""
        return self.rate.part.stations is None

    def given(self, shift: Shift, rest: Array) -> tuple[Complex, Array]:
        """Rates of forces and couples (d, k) where the dimensionless finger stays, but for its angle at rest (d, k)."""
        carried, length, turning = self._carried(shift)
        rates = self._changed(carried, rest + turning[:, None], length[:, None] * self.s * self.sections.length)
        rates += shift.parameter[:, None, None] * self.sampled.by_parameter
        rates[self.rate.rows] += self.by_numbers
        rates = self._kept(rates, turning)
        stretch = length if self.spread_out else 0.0 * length
        forces = self._forces(rates) + self.forces * (stretch - shift.log_force)[:, None]
        return forces, self._couples(rates) + self.couples * (stretch - shift.log_energy)[:, None]

    def moved(self, breaks: Array, bending: Bending, base: Array) -> Moved:
        """Rates as the deflected finger changes: its segments' ends (d, segments + 1), and what is bent."""
        points, turns, along = self._moving(breaks, bending, base)
        length = self.sections.length
        rates = self._changed(self.sampled.turn * length * points, turns, along * length)
        forces, couples = self._forces(rates), self._couples(rates)
        if self.spread_out:
            lengths = self.geometry.lengths
            wider = (np.diff(breaks, axis=1) / lengths)[:, self.segment]
            forces, couples = forces + wider * self.forces, couples + wider * self.couples
        return Moved(points, forces, couples)

    def potential_rates(self, shift: Shift, rest: Array, breaks: Array, bending: Bending, base: Array) -> Array:
        """Rates of its potential, in J, (d,), the place of the motion held."""
        sampled, length = self.sampled, self.sections.length
        points, turns, along = self._moving(breaks, bending, base)
        carried, stretch, turning = self._carried(shift)
        places = carried + sampled.turn * length * points
        angles = rest + turning[:, None] + turns
        s = stretch[:, None] * self.s * length + along * length
        x, y, couple = sampled.actions.T
        work = x * places.real + y * places.imag + couple * angles
        out: Array = -(work * sampled.each).sum(axis=1)
        own = np.zeros((len(out), 1 if not self.spread_out else self.s.size))
        own[self.rate.rows] = self.energy_by_numbers
        if not self.spread_out:
            return out + s @ self.energy_by_s + own[:, 0]
        wider = (np.diff(breaks, axis=1) / self.geometry.lengths)[:, self.segment] + stretch[:, None]
        density = own + s * self.energy_by_s + wider * sampled.energies
        return out + density @ sampled.each

    def _carried(self, shift: Shift) -> tuple[Complex, Array, Array]:
        """Rates of the places in m where the dimensionless finger stays (d, k), of log L and of the load's axes."""
        turning = shift.turning if self.rate.part.in_world else 0.0 * shift.turning
        return (shift.log_length + 1j * turning)[:, None] * self.sampled.place, shift.log_length, turning

    def _moving(self, breaks: Array, bending: Bending, base: Array) -> tuple[Complex, Array, Array]:
        """Rates of the sections' places, angles and arc lengths, by L, (d, k) each."""
        ends = breaks[:, self.segment], breaks[:, self.segment + 1]
        along = ends[0] * (1 - self.x) / 2 + ends[1] * (1 + self.x) / 2
        turns = bending.products @ self.marks.turns.T + base[:, None]
        if self.sections.rest is not None:
            turns = turns + along * self.sections.rest.curvature(self.s)[0]
        return bending.runs @ self.marks.places.T, turns, along

    def _changed(self, places: Complex, angles: Array, s: Array) -> Array:
        """Rates of the actions (d, k, 3) by those of places, angles and arc lengths, (d, k) each."""
        changes = np.stack([places.real, places.imag, angles], axis=2)
        if self.spread_out:
            return np.einsum("kcj,dkj->dkc", self.sampled.derivatives, changes) + self.by_s * s[..., None]
        turned = np.einsum("kcij,dij->dkc", self.sampled.derivatives, changes)
        return turned + np.einsum("kci,di->dkc", self.by_s, s)

    def _kept(self, rates: Array, turning: Array) -> Array:
        """Rates of the actions in axes that turn."""
        back = -1j * turning[:, None] * (self.sampled.actions[:, 0] + 1j * self.sampled.actions[:, 1])
        return rates + np.stack([back.real, back.imag, 0.0 * back.real], axis=2)

    def _forces(self, rates: Array) -> Complex:
        vectors = (rates[..., 0] + 1j * rates[..., 1]) / self.sampled.turn
        return np.asarray(self.sampled.each * vectors * self.units[0])

    def _couples(self, rates: Array) -> Array:
        return np.asarray(self.sampled.each * rates[..., 2] * self.units[1])


class Carried:
    """All loads on a finger.

    Parameters
    ----------
    bearings
        One a load.
    geometry
        Of the finger.
    """

    def __init__(self, bearings: Sequence[Bearing], geometry: Geometry) -> None:
        self.bearings = tuple(bearings)
        none = np.zeros(0)
        self.points, self.forces = (
            np.concatenate([none + 0j, *(getattr(b, name) for b in self.bearings)]) for name in ("points", "forces")
        )
        self.couples = np.concatenate([none, *(b.couples for b in self.bearings)])
        self.count = self.couples.size
        self.marks = geometry.marks(none, np.zeros(0, dtype=np.intp))
        for bearing in self.bearings:
            self.marks = self.marks.beside(bearing.marks)

    @classmethod
    def of(cls, loads: LoadRates, equilibrium: Equilibrium, geometry: Geometry) -> Carried:
        """The loads at an equilibrium."""
        acting, beam = equilibrium.obstacle.acting, equilibrium.state.beam
        if acting is None:
            return cls((), geometry)
        out = []
        for rate in loads.parts:
            stations, weights = rate.part.stations, None
            if stations is None:
                x = np.tile(2 * geometry.rule.along - 1, geometry.segments)
                segment, weights = beam.segment_of(beam.gauss), beam.gauss_lengths * rate.part.length
            else:
                segment = beam.segment_of(stations, left=True)
                x = (stations - beam.starts[segment]) / (beam.lengths[segment] / 2) - 1
            out.append(Bearing(rate, acting, equilibrium, geometry, x, segment, weights))
        return cls(out, geometry)

    def moved(self, breaks: Array, bending: Bending, base: Array) -> Moved:
        """Rates as the deflected finger changes."""
        parts = [bearing.moved(breaks, bending, base) for bearing in self.bearings]
        none = np.zeros((len(breaks), 0))
        points, forces = (
            np.concatenate([none + 0j, *(getattr(part, name) for part in parts)], axis=1)
            for name in ("points", "forces")
        )
        return Moved(points, forces, np.concatenate([none, *(part.couples for part in parts)], axis=1))

    def beyond(self, segment: int, x: float, middle: float) -> list[tuple[Bearing, Array]]:
        """All that acts further out than a section, each with which of it (or how much) counts."""
        out: list[tuple[Bearing, Array]] = []
        for bearing in self.bearings:
            if not bearing.spread_out:
                out.append((bearing, (bearing.s > middle).astype(float)))
                continue
            out.append((bearing, (bearing.segment > segment).astype(float)))
            near, weights = np.polynomial.legendre.leggauss(_NEAR)
            half = (1 - x) / 2
            stands = weights * half * float(bearing.geometry.lengths[segment]) / 2 * bearing.rate.part.length
            places = x + half * (near + 1)
            out.append((bearing.at(places, np.full(_NEAR, segment), stands), np.ones(_NEAR)))
        return out
