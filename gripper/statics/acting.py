"""Loads on a deflected finger: generalised forces on its unknowns, their derivatives, the potential.

With B the rates of place and angle of the sections that a load acts on, and F its action on them, the generalised
force is F . B, and its derivative B^T F' B + F . d2r/dz2. Dimensionless (:mod:`gripper.beam.sections`).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.axis import Axis
from gripper.beam.strains import Rows
from gripper.contact.obstacle import Stage
from gripper.statics.compiled_loads import CompiledLoad, Loads

if TYPE_CHECKING:
    from gripper.statics.equilibrium import State

_NEAR = 12  # Gauss points between a section and the end of its segment


@dataclass(frozen=True, eq=False)
class Push:
    """What the loads do to the unknowns z (n,), over EI(0) / L: minus the gradient of a potential where they have one.

    Parameters
    ----------
    force
        Generalised forces, (n,).
    slopes
        Their derivatives by z, (n, n); not symmetric where a load follows the finger.
    rates
        Their rates with the path's parameter, (n,).
    potential
        Of those loads that have one.
    conservative
        Whether all have one.
    """

    force: Array
    slopes: Array
    rates: Array
    potential: float
    conservative: bool


@dataclass(frozen=True, eq=False)
class Felt:
    """What acts on sections of the axis: places (k,), forces (k,) over EI(0) / L^2, couples (k,) over EI(0) / L."""

    s: Array
    points: Complex
    forces: Complex
    couples: Array


@dataclass(frozen=True, eq=False)
class Acting:
    """Loads at a stage; ``part`` of their size on the way from none."""

    loads: Loads
    stage: Stage
    part: float = 1.0

    def push(self, axis: Axis) -> Push:
        """The generalised forces on the unknowns of an axis."""
        n = axis.beam.size
        force, slopes, rates, potential = np.zeros(n), np.zeros((n, n)), np.zeros(n), 0.0
        for load in self.loads.parts:
            each = self.sampled(load, axis)
            force += each.force()
            slopes += each.slopes()
            rates += each.rates()
            potential += each.potential()
        unit = self.part / self.loads.sections.energy_scale
        return Push(unit * force, unit * slopes, unit * rates, unit * potential, self.loads.conservative)

    def sampled(self, load: CompiledLoad, axis: Axis) -> Sampled:
        """A load on the sections that it acts on; of one along the whole axis, on the Gauss points."""
        beam = axis.beam
        if load.stations is None:
            weights = beam.gauss_lengths * load.length
            return Sampled(load, axis, self.stage, beam.gauss, beam.segment_of(beam.gauss), weights)
        segment = beam.segment_of(load.stations, left=True)
        return Sampled(load, axis, self.stage, load.stations, segment, None)

    def each(self, axis: Axis) -> list[Felt]:
        """What each load does to the sections that it acts on, in the clamp's frame; weight as many small forces."""
        return [self.sampled(load, axis).felt(self._units) for load in self.loads.parts]

    def felt(self, axis: Axis) -> Felt:
        """What all of them do."""
        parts = self.each(axis)
        return Felt(*(np.concatenate([getattr(part, name) for part in parts]) for name in Felt.__dataclass_fields__))

    @property
    def _units(self) -> tuple[float, float]:
        scales = self.loads.sections
        return self.part / scales.force_scale, self.part / scales.energy_scale

    def beyond(self, axis: Axis, s: Array, segment: Index) -> tuple[Complex, Array]:
        """Force and couple about each section s (k,) of all that acts further out, both (k,)."""
        here = axis.values(s, segment)[0]
        total, couple = np.zeros(s.size, dtype=complex), np.zeros(s.size)
        for load in self.loads.parts:
            if load.stations is None:
                self._weighed(load, axis, s, segment, here, total, couple)
                continue
            found = self.sampled(load, axis).felt(self._units)
            out = found.s > s[:, None]
            total += out @ found.forces
            arms = ((found.points - here[:, None]).conj() * found.forces).imag + found.couples
            couple += np.sum(out * arms, axis=1)
        return total, couple

    def _weighed(
        self, load: CompiledLoad, axis: Axis, s: Array, segment: Index, here: Complex, total: Complex, couple: Array
    ) -> None:
        """Add what acts along the axis beyond each section: the rest of its segment, and the segments after it."""
        beam = axis.beam
        whole = self.sampled(load, axis).felt(self._units)
        own = np.repeat(np.arange(beam.segments), beam.gauss.size // beam.segments)
        x, weights = np.polynomial.legendre.leggauss(_NEAR)
        rest = (np.array(beam.breaks)[segment + 1] - s)[:, None] / 2
        marks = (s[:, None] + rest * (x + 1)).ravel()
        near = Sampled(
            load, axis, self.stage, marks, np.repeat(segment, _NEAR), (rest * weights).ravel() * load.length
        ).felt(self._units)
        beside = np.repeat(np.eye(s.size, dtype=bool), _NEAR, axis=1)
        for found, out in ((whole, own > segment[:, None]), (near, beside)):
            arms = ((found.points - here[:, None]).conj() * found.forces).imag + found.couples
            total += out @ found.forces
            couple += np.sum(out * arms, axis=1)


class LoadEnergy:
    """What loads add to the energy that is minimised, over EI(0) / L.

    Loads without a potential are those of a start, kept: a minimum tells who touches, no more.
    """

    def __init__(self, acting: Acting, start: State) -> None:
        self._acting, self._beam = acting, start.beam
        self._kept = None if acting.loads.conservative else acting.push(start.axis).force

    def _push(self, z: Array) -> Push:
        return self._acting.push(Axis.of(self._beam, z))

    def energy(self, z: Array) -> float:
        """The potential."""
        return self._push(z).potential if self._kept is None else -float(self._kept @ z)

    def slope(self, z: Array) -> Array:
        """Its gradient, (n,)."""
        return -self._push(z).force if self._kept is None else -self._kept

    def curvature(self, z: Array) -> Array:
        """Its Hessian, (n, n)."""
        return -self._push(z).slopes if self._kept is None else np.zeros((z.size, z.size))


class Sampled:
    """One load on the sections of an axis, in SI: its own axes for places and actions.

    Parameters
    ----------
    load, axis, stage
        Of what.
    s, segment
        The sections (k,), by L.
    weights
        The length that each stands for, in m; None of a load on single sections.
    """

    def __init__(
        self, load: CompiledLoad, axis: Axis, stage: Stage, s: Array, segment: Index, weights: Array | None
    ) -> None:
        self.load, self.axis, self.s, self.segment, self.weights = load, axis, s, segment, weights
        self.turn = np.exp(1j * stage.turn) if load.in_world else 1.0 + 0j
        self.stage = stage if load.in_world else Stage(stage.parameter, 0.0, stage.pace, 0.0)
        self.points, psi, *_ = axis.values(s, segment)
        self.place = self.turn * load.length * self.points
        self.angles = psi + self.stage.turn
        found = load.values(s * load.length, self.place.real, self.place.imag, self.angles, stage.parameter)
        self.actions, self.derivatives, self.by_parameter, self.energies = found

    @functools.cached_property
    def maps(self) -> Array:
        """Rates of x, y and angle with z, (k, 3, n)."""
        rows = self.rows
        moving = self.turn * self.load.length * (rows.position @ self.axis.turning)
        return np.stack([moving.real, moving.imag, rows.strains[0]], axis=1)

    @functools.cached_property
    def rows(self) -> Rows:
        """The maps to the sections."""
        return self.axis.beam.rows(self.s, self.segment)

    @functools.cached_property
    def each(self) -> Array:
        """What each section counts, (k,): 1, or the length that it stands for, in m."""
        return np.ones(self.s.size) if self.weights is None else self.weights

    @property
    def _vectors(self) -> Complex:
        """Forces in the clamp's axes, weighted."""
        return self.each * (self.actions[:, 0] + 1j * self.actions[:, 1]) / self.turn

    def potential(self) -> float:
        """Of these sections, in J."""
        return float(np.sum(self.each * self.energies)) if self.weights is not None else float(self.energies)

    def force(self) -> Array:
        """Generalised forces on z, in J, (n,)."""
        found: Array = np.einsum("k,kc,kcn->n", self.each, self.actions, self.maps)
        return found

    def along(self, changes: Array) -> Array:
        """Change of the actions (k, 3) by changes of place and angle (k, 3, ...)."""
        if self.weights is not None:
            return np.einsum("kcd,kd...->kc...", self.derivatives, changes)
        return np.einsum("kcjd,jd...->kc...", self.derivatives, changes)

    def slopes(self) -> Array:
        """Their derivatives by z, (n, n)."""
        straining = np.einsum("k,kcn,kcm->nm", self.each, self.maps, self.along(self.maps))
        found: Array = straining + self.load.length * self.axis.second_derivative(self._vectors @ self.rows.position)
        return found

    def rates(self) -> Array:
        """The clamp turns the places, and the axes that the forces keep to."""
        pace, turning = self.stage.pace, self.stage.turning
        if not pace and not turning:
            return np.zeros(self.axis.beam.size)
        carried = 1j * self.place
        changes = np.stack([carried.real, carried.imag, np.ones(self.s.size)], axis=1)
        rate = pace * self.by_parameter + turning * self.along(changes)
        back = -1j * turning * (self.actions[:, 0] + 1j * self.actions[:, 1])
        rate = rate + np.stack([back.real, back.imag, np.zeros(self.s.size)], axis=1)
        found: Array = np.einsum("k,kc,kcn->n", self.each, rate, self.maps)
        return found

    def felt(self, units: tuple[float, float]) -> Felt:
        """What acts on the sections, forces and couples in these units."""
        return Felt(self.s, self.points, units[0] * self._vectors, units[1] * self.each * self.actions[:, 2])
