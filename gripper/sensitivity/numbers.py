"""The rates of a pose's numbers, in SI units, world frame unless named otherwise."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from gripper.answer import largest_strain
from gripper.arrays import Array, Complex
from gripper.equilibrium import Equilibrium
from gripper.outline import dot
from gripper.sensitivity.seeds import FrameRates, Seeds
from gripper.sensitivity.tangent import Rates, rates
from gripper.sensitivity.touching import Touching

Table: TypeAlias = dict[str, Array]
"""Rates by name: (p,), or (p, 2) of vectors."""


def pose_rates(seeds: Seeds, equilibrium: Equilibrium) -> Table:
    """The rates of an equilibrium's numbers by those of its scene.

    Parameters
    ----------
    seeds
        The numbers of the scene, p of them.
    equilibrium
        With contacts.
    """
    parameter = equilibrium.obstacle.frame.parameter
    touching, frames = seeds.touching(equilibrium), seeds.frames(parameter)
    found = rates(touching, seeds.change(touching, frames))
    return Reading(seeds, touching, frames, found, parameter).table()


def free_rates(seeds: Seeds, equilibrium: Equilibrium) -> Table:
    """The rates of a finger that touches nothing: it moves with its clamp, and that is all."""
    parameter = equilibrium.obstacle.frame.parameter
    frames, count = seeds.frames(parameter), len(seeds.keys)
    turn = np.exp(1j * seeds.kinematics.placement(parameter or 0.0).clamp[2])
    length = seeds.setting.sections.length
    tip = frames.clamp + turn * length * (seeds.log_length + 1j * frames.clamp_angle)
    none, plane = np.zeros(count), np.zeros((count, 2))
    moving = {} if parameter is None else {"motion_force": none}
    scalars = dict.fromkeys(("energy", "moment_on_object", "clamp_moment", "tip_rotation", "max_strain"), none)
    return (
        scalars
        | moving
        | {
            "force_on_object": plane,
            "force_on_object_finger_frame": plane,
            "tip": _plane(tip),
        }
    )


class Reading:
    """The numbers of a pose and their rates."""

    def __init__(
        self, seeds: Seeds, touching: Touching, frames: FrameRates, found: Rates, parameter: float | None
    ) -> None:
        self.seeds, self.touching, self.frames, self.rates = seeds, touching, frames, found
        self.parameter = parameter
        self.scales = seeds.setting.sections

    def table(self) -> Table:
        """All rates by name."""
        t, rates, scales = self.touching, self.rates, self.scales
        energy = rates.energy + t.equilibrium.state.energy * self.seeds.log_energy
        local = -(rates.flow.forces.sum(axis=1) + t.forces.sum() * self.seeds.log_force)
        turn = np.exp(1j * self.seeds.kinematics.placement(self.parameter or 0.0).clamp[2])
        world = turn * (local - 1j * self.frames.clamp_angle * t.forces.sum())
        out = {
            "energy": energy * scales.energy_scale,
            "force_on_object": _plane(world * scales.force_scale),
            "force_on_object_finger_frame": _plane(local * scales.force_scale),
            "moment_on_object": -self._moment(t.equilibrium.obstacle.frame.origin, self.frames.origin),
            "clamp_moment": self._moment(0j, 0j * self.frames.origin),
            "max_strain": self._strain(),
        }
        if self.parameter is not None:
            out["motion_force"] = self._drive()
        return out | self._tip(turn)

    def _moment(self, about: complex, moving: Complex) -> Array:
        """Rate of the moment of the forces on the finger about a point, in N m."""
        t, moved = self.touching, self.rates.flow
        arms, changes = t.points - about, moved.points - np.reshape(moving, (-1, 1))
        rate = (changes.conj() * t.forces + arms.conj() * moved.forces).imag.sum(axis=1)
        whole = float((arms.conj() * t.forces).imag.sum())
        return (rate + whole * self.seeds.log_energy) * self.scales.energy_scale

    def _drive(self) -> Array:
        """Rate of the motion's force."""
        t, moved, frame = self.touching, self.rates.flow, self.touching.obstacle.frame
        velocities = t.obstacle.velocities(t.points)
        changes = self.frames.velocity[:, None] + 1j * frame.spin * (moved.points - self.frames.origin[:, None])
        changes += 1j * self.frames.spin[:, None] * (t.points - frame.origin)
        rate = (dot(moved.forces, velocities) + dot(t.forces, changes)).sum(axis=1)
        whole = float(dot(t.forces, velocities).sum())
        return (rate + whole * self.seeds.log_energy) * self.scales.energy_scale

    def _tip(self, turn: complex) -> Table:
        geometry = self.touching.geometry
        end = geometry.marks(np.ones(1), np.array([geometry.segments - 1]))
        position = complex((end.places @ geometry.runs)[0])
        change = (self.rates.flow.bending.runs @ end.places.T)[:, 0]
        local = change + position * (self.seeds.log_length + 1j * self.frames.clamp_angle)
        rotation: Array = (self.rates.flow.bending.products @ end.turns.T)[:, 0]
        return {"tip": _plane(self.frames.clamp + turn * local * self.scales.length), "tip_rotation": rotation}

    def _strain(self) -> Array:
        """Rate of the largest strain at the section where it is: the place is stationary, or held by the segments."""
        t, geometry = self.touching, self.touching.geometry
        value, s = largest_strain(t.setting, t.equilibrium)
        segment, x = self._section(s)
        marks = geometry.marks(np.array([x]), np.array([segment]))
        position = complex((marks.places @ geometry.runs)[0])
        beyond = np.where(t.flexible > 0, t.s, 2.0) > s - x * 5e-10  # which side of a force a break is read on
        arms = t.points - position
        moment = float(np.sum(beyond * (arms.conj() * t.forces).imag))
        changes = self.rates.flow.points - self.rates.flow.bending.runs @ marks.places.T
        rate = (beyond * (changes.conj() * t.forces + arms.conj() * self.rates.flow.forces).imag).sum(axis=1)
        place = np.array([s])
        stiffer, thicker = self._section_rates(place, segment, x)
        stiff, thick = t.setting.sections.EI(place)[0], t.setting.sections.thickness(place)[0]
        return np.asarray(value * (rate / moment - stiffer / stiff + thicker / thick))

    def _section(self, s: float) -> tuple[int, float]:
        """The segment in which a place is read, and where in it; at a break the side on which the moment is larger."""
        beam = self.touching.beam
        segment = int(beam.segment_of(np.array([s]))[0])
        x = (s - beam.starts[segment]) / (beam.lengths[segment] / 2) - 1
        if segment and x < -1 + 1e-9:
            return segment - 1, 1.0
        return segment, float(np.clip(x, -1.0, 1.0))

    def _section_rates(self, sigma: Array, segment: int, x: float) -> tuple[Array, Array]:
        """Rates of EI and w / L at a place of a segment that moves with it."""
        seeds, breaks = self.seeds, self.rates.change.breaks
        moving = breaks[:, segment] * (1 - x) / 2 + breaks[:, segment + 1] * (1 + x) / 2
        _, slope, stiffer = seeds.finger.stiffness(sigma, 1)
        thick, _ = seeds.finger.thickness(sigma)
        w_slope = np.asarray(seeds.setting.sections.profile(sigma)[1]).ravel()[0]
        return (
            seeds.spread(stiffer[:, 0, 0]) + slope[0, 0] * moving,
            seeds.spread(thick[:, 0]) + w_slope * moving,
        )


def _plane(vectors: Complex) -> Array:
    return np.column_stack([vectors.real, vectors.imag])
