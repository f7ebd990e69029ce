"""The rates of a pose's numbers, in SI units, world frame unless named otherwise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.outline import dot
from gripper.sensitivity.gap_rates import gap_rates
from gripper.sensitivity.geometry import Marks
from gripper.sensitivity.jet import Jet, NotFormedError, value_of
from gripper.sensitivity.section_rates import Sectioned
from gripper.sensitivity.seeds import Seeds, Solved
from gripper.sensitivity.tangent import stored_rates
from gripper.statics.equilibrium import Equilibrium
from gripper.statics.profile import largest_strain

_AT_END = 1e-9  # of half a segment
_Known: TypeAlias = tuple[Array, Array]  # a number, and its rates
Table: TypeAlias = dict[str, Array]
"""Rates by name: (p,), or (p, 2) of vectors."""


class Reading:
    """The numbers of an equilibrium, and their rates by those of its scene.

    Parameters
    ----------
    seeds
        The numbers of the scene, p of them.
    equilibrium
        Of the scene.
    """

    def __init__(self, seeds: Seeds, equilibrium: Equilibrium) -> None:
        self._read(seeds, seeds.solved(equilibrium))

    @classmethod
    def of(cls, seeds: Seeds, solved: Solved) -> Reading:
        """The same of what is solved already."""
        reading = cls.__new__(cls)
        reading._read(seeds, solved)
        return reading

    def _read(self, seeds: Seeds, solved: Solved) -> None:
        self.seeds, self.scales = seeds, seeds.setting.sections
        self.touching, self.frames, self.rates = solved.touching, solved.frames, solved.rates
        self.parameter = solved.touching.equilibrium.obstacle.frame.parameter

    def table(self) -> Table:
        """All rates by name."""
        t, scales = self.touching, self.scales
        local = self._force()
        turn = np.exp(1j * self.seeds.kinematics.placement(self.parameter or 0.0).clamp[2])
        world = turn * (local - 1j * self.frames.clamp_angle * t.forces.sum())
        out = {
            "energy": self.energy(),
            "force_on_object": _plane(world * scales.force_scale),
            "force_on_object_finger_frame": _plane(local * scales.force_scale),
            "moment_on_object": -self._moment(t.equilibrium.obstacle.frame.origin, self.frames.origin),
            "clamp_moment": self._moment(0j, 0j * self.frames.origin) + self._load_moment(),
            "max_strain": self.strain(),
            "min_gap": gap_rates(self.seeds, t.equilibrium),
        }
        if self.parameter is not None:
            out["motion_force"] = self.drive()
        push = t.equilibrium.linear.push
        if push is not None and push.conservative:
            out["load_energy"] = self.load_energy()
        return out | self._tip(turn)

    def energy(self) -> Array:
        """Rate of the strain energy, in J."""
        t, found = self.touching, self.rates
        rates = found.unknowns @ t.equilibrium.state.energy_gradient + stored_rates(t, found.change)
        whole = t.equilibrium.state.energy * self.seeds.log_energy
        return np.asarray((rates + whole) * self.scales.energy_scale)

    def size(self) -> Array:
        """Rate of the size of the force on the object, in N."""
        force = -self.touching.forces.sum()
        found: Array = (self._force() * (force / abs(force)).conjugate()).real * self.scales.force_scale
        return found

    def _force(self) -> Complex:
        """Rate of the force on the object in the clamp's axes, over EI(0) / L^2."""
        whole = self.touching.forces.sum() * self.seeds.log_force
        found: Complex = -(self.rates.flow.forces.sum(axis=1) + whole)
        return found

    def _moment(self, about: complex, moving: Complex) -> Array:
        """Rate of the moment of the forces on the finger about a point, in N m."""
        t, moved = self.touching, self.rates.flow
        arms, changes = t.points - about, moved.points - np.reshape(moving, (-1, 1))
        rate = (changes.conj() * t.forces + arms.conj() * moved.forces).imag.sum(axis=1)
        whole = float((arms.conj() * t.forces).imag.sum())
        return (rate + whole * self.seeds.log_energy) * self.scales.energy_scale

    def _load_moment(self) -> Array:
        """Rate of the moment of the loads about the clamp, in N m."""
        held, moved = self.touching.carried, self.rates.flow.loads
        arms = (moved.points.conj() * held.forces + held.points.conj() * moved.forces).imag
        rate = (arms + moved.couples).sum(axis=1)
        whole = float(((held.points.conj() * held.forces).imag + held.couples).sum())
        return np.asarray((rate + whole * self.seeds.log_energy) * self.scales.energy_scale)

    def load_energy(self) -> Array:
        """Rate of the loads' potential, in J, at a fixed place of the motion."""
        found, shift, change = np.zeros(len(self.seeds.keys)), self.seeds.shift(self.frames), self.rates.change
        for bearing in self.touching.carried.bearings:
            rest = self.seeds.rest(bearing.s)
            found += bearing.potential_rates(shift, rest, change.breaks, self.rates.flow.bending, change.base_turns)
        return found

    def drive(self) -> Array:
        """Rate of the motion's force."""
        t, moved, frame = self.touching, self.rates.flow, self.touching.obstacle.frame
        velocities = t.obstacle.velocities(t.points)
        changes = self.frames.velocity[:, None] + 1j * frame.spin * (moved.points - self.frames.origin[:, None])
        changes += 1j * self.frames.spin[:, None] * (t.points - frame.origin)
        rate = (dot(moved.forces, velocities) + dot(t.forces, changes)).sum(axis=1)
        whole = dot(t.forces, velocities).sum()
        return (rate + whole * self.seeds.log_energy) * self.scales.energy_scale

    def _tip(self, turn: complex) -> Table:
        geometry = self.touching.geometry
        end = geometry.marks(np.ones(1), np.array([geometry.segments - 1]))
        position = complex((end.places @ geometry.runs)[0])
        change = (self.rates.flow.bending.runs @ end.places.T)[:, 0]
        local = change + position * (self.seeds.log_length + 1j * self.frames.clamp_angle)
        rotation = (self.rates.flow.bending.products @ end.turns.T)[:, 0] + self.rates.change.base_turns
        rotation = rotation + self.seeds.rest(np.ones(1))[:, 0]
        return {"tip": _plane(self.frames.clamp + turn * local * self.scales.length), "tip_rotation": rotation}

    def strain(self) -> Array:
        """Rate of the largest strain at the section where it is: the place is stationary, or held by the segments."""
        t = self.touching
        if not t.sites and not t.carried.count:
            return np.zeros(len(self.seeds.keys))
        value, s = largest_strain(t.setting, t.equilibrium)
        section = self._section(s)
        if isinstance(t.points, Jet) and abs(section.x) < 1 - _AT_END:
            raise NotFormedError("a strain that is largest between contacts")
        strain, found = self._strained(section)
        rates: Array = value / value_of(strain) * found
        return rates

    def _strained(self, section: _Section) -> _Known:
        """The strain of a section, and its rates."""
        t = self.touching
        moment, force, rates = self._outer(section)
        along, pulling = self._pull(section, force, rates[1]) if t.beam.stretches else (np.zeros(()), 0.0 * rates[0])
        if t.setting.sections.law is None:
            return self._linear(section, (moment, rates[0]), (along, pulling))
        return self._lawful(section, (moment, rates[0]), (along, pulling))

    def _linear(self, section: _Section, moment: _Known, along: _Known) -> _Known:
        """The strain of a section under M and N, and its rates."""
        stiff, thick, stiffer, thicker = self._section_rates(section)
        strain = abs(moment[0]) / stiff[0] * thick / 2
        rates = strain * (moment[1] / moment[0] - stiffer[:, 0] / stiff[0] + thicker / thick)
        stretch = abs(along[0]) / stiff[2]
        return strain + stretch, rates + np.sign(along[0]) * along[1] / stiff[2] - stretch * stiffer[:, 2] / stiff[2]

    def _lawful(self, section: _Section, moment: _Known, along: _Known) -> _Known:
        """The same under a law of the material's own."""
        t, moving = self.touching, self._moving(section)
        segment = np.array([section.segment])
        strains = t.beam.strains(t.equilibrium.state.z, section.place, segment)
        made = Sectioned(self.seeds.finger, section.place, t.beam.fields)
        return made.strain(strains, moment, along, lambda rates: self.seeds.spread(rates[1:, 0]) + moving * rates[0, 0])

    def strain_place(self) -> Array | None:
        """Rate of the place of the largest strain, in m; None where it is not held by the end of a segment."""
        _, s = largest_strain(self.touching.setting, self.touching.equilibrium)
        section = self._section(s)
        if abs(section.x) < 1 - _AT_END:
            return None
        return np.asarray((self._moving(section) + s * self.seeds.log_length) * self.scales.length)

    def _outer(self, section: _Section) -> tuple[Array, Complex, tuple[Array, Complex]]:
        """Moment and force of all that acts further out than a section, and their rates."""
        t, moved = self.touching, self.rates.flow
        here = (section.marks.places @ t.geometry.runs)[0]
        passing = moved.bending.runs @ section.marks.places.T
        s = float(value_of(section.place)[0])
        middle = s - section.x * 5e-10  # which side of a force a break is read on
        beyond = np.where(t.flexible > 0, t.s, 2.0) > middle
        parts = [(beyond, t.points, t.forces, 0 * t.s, moved.points, moved.forces, 0 * t.s)]
        shift, breaks = self.seeds.shift(self.frames), self.rates.change.breaks
        for bearing, counts in t.carried.beyond(section.segment, section.x, middle):
            found = bearing.moved(breaks, moved.bending, self.rates.change.base_turns)
            forces, couples = bearing.given(shift, self.seeds.rest(bearing.s))
            felt = bearing.points, bearing.forces, bearing.couples
            parts.append((counts, *felt, found.points, found.forces + forces, found.couples + couples))
        moment, force = np.zeros(()), np.zeros((), dtype=complex)
        turning, pulling = np.zeros(len(self.seeds.keys)), np.zeros(len(self.seeds.keys), dtype=complex)
        for counts, points, forces, couples, going, forcing, twisting in parts:
            arms, changes = points - here, going - passing
            moment = moment + counts @ ((arms.conj() * forces).imag + couples)
            turning = turning + ((changes.conj() * forces + arms.conj() * forcing).imag + twisting) @ counts
            force, pulling = force + counts @ forces, pulling + forcing @ counts
        return moment, force, (turning, pulling)

    def _pull(self, section: _Section, force: Complex, pulling: Complex) -> _Known:
        """The force along a section's normal, and its rate."""
        t, moved, rest = self.touching, self.rates.flow, self.touching.rest
        psi = (section.marks.turns @ t.geometry.products)[0] + t.geometry.base_turn
        turning = (moved.bending.products @ section.marks.turns.T)[:, 0] + self.rates.change.base_turns
        if rest is not None:
            psi += rest.angle(section.place)[0]
            turning = turning + self._moving(section) * rest.curvature(section.place)[0]
        turning = turning + self.seeds.rest(section.place)[:, 0]
        normal = np.exp(1j * psi)
        rate: Array = (normal.conj() * pulling).real + ((1j * normal).conj() * force).real * turning
        return (normal.conj() * force).real, rate

    def _section(self, s: float) -> _Section:
        """A place, in the segment in which it is read; at a break in the one before."""
        beam = self.touching.beam
        segment = int(beam.segment_of(np.array([s]))[0])
        x = float((s - beam.starts[segment]) / (beam.lengths[segment] / 2) - 1)
        segment, x = (segment - 1, 1.0) if segment and x < -1 + 1e-9 else (segment, min(max(x, -1.0), 1.0))
        marks = self.touching.geometry.marks(np.array([x]), np.array([segment]))
        return _Section(np.array([s]), segment, x, marks)

    def _moving(self, section: _Section) -> Array:
        """How a place of a segment moves with it."""
        breaks, x = self.rates.change.breaks, section.x
        moved: Array = breaks[:, section.segment] * (1 - x) / 2 + breaks[:, section.segment + 1] * (1 + x) / 2
        return moved

    def _section_rates(self, section: _Section) -> tuple[Array, float, Array, Array]:
        """Stiffness (3,) and w / L at a place of a segment that moves with it, and their rates."""
        seeds, moving = self.seeds, self._moving(section)
        stiff, slope, stiffer = seeds.finger.stiffness(section.place, 3)
        thick, slender = seeds.finger.thickness(section.place)[0], seeds.setting.sections.profile(section.place)
        return (
            stiff[:, 0],
            np.ravel(slender[0])[0],
            np.column_stack([seeds.spread(stiffer[:, i, 0]) + slope[i, 0] * moving for i in range(3)]),
            seeds.spread(thick[:, 0]) + np.ravel(slender[1])[0] * moving,
        )


@dataclass(frozen=True, eq=False)
class _Section:
    """A section, in its segment."""

    place: Array  # by L, (1,)
    segment: int
    x: float
    marks: Marks


def _plane(vectors: Complex) -> Array:
    return np.column_stack([vectors.real, vectors.imag])
