"""What the numbers of a scene change in the dimensionless problem of one pose: the directions of forward mode."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
import sympy

from gripper.arrays import Array, Complex
from gripper.contact.kinematics import Kinematics
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER, dot
from gripper.contact.site import Site
from gripper.friction import Coefficients
from gripper.parameters import numbers
from gripper.scene import Scene
from gripper.sensitivity.bearing import Shift
from gripper.sensitivity.finger_rates import FingerRates
from gripper.sensitivity.flow import Change
from gripper.sensitivity.jet import jet
from gripper.sensitivity.load_rates import LoadRates
from gripper.sensitivity.memory import Memory
from gripper.sensitivity.object_rates import object_rates
from gripper.sensitivity.tangent import Rates, rates
from gripper.sensitivity.touching import Touching
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.statics.newton import polished

MOTION = "the motion's parameter"
_POSES = ("x", "y", "angle")
_SAME = 1e-9  # of L


@dataclass(frozen=True, eq=False)
class FrameRates:
    """Rates of a pose's frames, by each number: the object's by L in the clamp's axes, the clamp's in the world."""

    origin: Complex
    angle: Array
    velocity: Complex
    spin: Array
    clamp: Complex  # in m
    clamp_angle: Array


@dataclass(frozen=True, eq=False)
class Solved:
    """An equilibrium read at its contacts, and its rates by each number."""

    touching: Touching
    frames: FrameRates
    rates: Rates


class Seeds:
    """The directions of some numbers of a scene.

    Parameters
    ----------
    scene, setting
        What is solved.
    keys
        Numbers, as :func:`gripper.parameters.numbers` names them; after them comes the motion's parameter, if any.

    Raises
    ------
    LookupError
        An unknown number; lists the known ones.
    NotOpenError
        A plugin whose formulas sympy cannot differentiate.
    """

    def __init__(self, scene: Scene, setting: Setting, keys: Sequence[str]) -> None:
        known = numbers(scene)
        for key in keys:
            if key not in known:
                rule = "be a number that the scene has, to be differentiated by"
                raise ValueError(f"{key} must {rule} (without friction there is no side to slip to); got none")
        self.scene, self.setting, self.keys = scene, setting, (*keys, *([MOTION] if scene.motion else []))
        self._memory = Memory(self)
        self._solved: dict[Equilibrium, Solved] = {}
        self.kinematics = Kinematics(scene, setting.sections.length)
        finger = {self._inner(key): known[key] for key in keys if self._table(key) == "finger"}
        loading = {key: known[key] for key in keys if self._table(key) in ("finger", "loads")}
        body = {key.split(".", 1)[1]: known[key] for key in keys if self._table(key) == "object"}
        self.finger = FingerRates(setting.outline, finger)
        self.object = object_rates(setting.body, body)
        self._finger_rows = np.array([keys.index(self._outer(key)) for key in self.finger.keys], dtype=np.intp)
        self._object_rows = np.array([keys.index(f"object.{key}") for key in body], dtype=np.intp)
        self.loads = LoadRates(setting.loads, setting.sections, loading, {key: keys.index(key) for key in loading})
        self.log_length = self.spread(self.finger.log_length)
        self.log_stiffness = self.spread(self.finger.log_stiffness)
        base = setting.sections.finger.base
        softer = np.array([float(key == "finger.base.rotational_stiffness") for key in self.keys])
        self.log_base = softer / base.rotational_stiffness - self.log_energy if base else softer

    @staticmethod
    def _table(key: str) -> str:
        head, *rest = key.split(".")
        if head == "material":
            return "finger"
        if head.startswith("loads["):
            return "loads"
        return "pose" if rest and rest[0] == "pose" else head

    @staticmethod
    def _inner(key: str) -> str:
        return key if key.startswith("material.") else key.split(".", 1)[1]

    @staticmethod
    def _outer(key: str) -> str:
        return key if key.startswith("material.") else f"finger.{key}"

    def spread(self, rates: Array) -> Array:
        """Rates by the finger's numbers as rates by all."""
        out = np.zeros(len(self.keys))
        out[self._finger_rows] = rates
        return out

    @property
    def log_force(self) -> Array:
        """Relative rates of EI(0) / L^2."""
        return self.log_stiffness - 2 * self.log_length

    @property
    def log_energy(self) -> Array:
        """Relative rates of EI(0) / L."""
        return self.log_stiffness - self.log_length

    def frames(self, parameter: float | None) -> FrameRates:
        """Rates of the frames at a value of the motion's parameter."""
        kinematics, value = self.kinematics, parameter or 0.0
        frame, turning = kinematics.frame(value), kinematics.turning(value)[0]
        clamp = kinematics.placement(value).clamp
        back = cmath.exp(-1j * clamp[2]) / kinematics.length
        body, held = (self._shifts(name) for name in ("object", "finger"))
        origin = back * (body[0] - held[0]) - frame.origin * (1j * held[1] + self.log_length)
        drift = frame.velocity + 1j * turning * frame.origin
        velocity = -drift * (1j * held[1] + self.log_length) - 1j * turning * origin
        found = FrameRates(origin, body[1] - held[1], velocity, np.zeros(len(self.keys)), held[0], held[1])
        if self.keys[-1:] == (MOTION,):
            along = kinematics.clamp_velocity(value)
            drive = (frame.velocity, frame.spin, *kinematics.acceleration(value), along, turning)
            for field, rate in zip(fields(found), drive, strict=True):
                getattr(found, field.name)[-1] = rate
        return found

    def going(self, parameter: float) -> FrameRates:
        """The same, carrying their rates with the parameter."""
        kinematics, known = self.kinematics, self.frames(parameter)
        frame, (turning, turning_on) = kinematics.frame(parameter), kinematics.turning(parameter)
        gaining = kinematics.acceleration(parameter)[0]
        held = 1j * self._shifts("finger")[1] + self.log_length
        drift = gaining + 1j * (turning_on * frame.origin + turning * frame.velocity)
        speeding = -drift * held - 1j * (turning_on * known.origin + turning * known.velocity)
        jolting = np.zeros(len(self.keys))
        speeding[-1], jolting[-1] = kinematics.jerk(parameter)
        return replace(
            known,
            origin=jet(known.origin, known.velocity),
            angle=jet(known.angle, known.spin),
            velocity=jet(known.velocity, speeding),
            spin=jet(known.spin, jolting),
        )

    def _shifts(self, name: str) -> tuple[Complex, Array]:
        """Rates of a pose in the world: place and angle."""
        x, y, angle = (np.array([float(key == f"{name}.pose.{axis}") for key in self.keys]) for axis in _POSES)
        return x + 1j * y, angle

    def solved(self, equilibrium: Equilibrium) -> Solved:
        """The rates of an equilibrium by all numbers, reckoned once: of it to round-off.

        Raises
        ------
        NoEquilibriumError, LinAlgError
            At a limit point.
        """
        known = self._solved.get(equilibrium)
        if known is None:
            touching = Touching(self.setting, polished(self.setting, equilibrium), self.finger, self.loads)
            frames = self.frames(equilibrium.obstacle.frame.parameter)
            known = Solved(touching, frames, rates(touching, self.change(touching, frames)))
            self._solved[equilibrium] = known
        return known

    def change(self, touching: Touching, frames: FrameRates) -> Change:
        """The directions of all numbers at an equilibrium."""
        change = Change.none(touching, len(self.keys))
        self._of_finger(touching, change)
        self._of_loads(touching, change, frames)
        self._of_object(touching, change, frames)
        self._of_friction(touching, change)
        self._memory.change(touching, change, frames)
        return change

    def _of_finger(self, t: Touching, change: Change) -> None:
        rows = self._finger_rows
        change.stresses[rows], change.densities[rows] = t.sections.stress_rates, t.sections.density_rates
        change.base[:] = self.log_base
        change.rest[rows] = self.finger.rest(t.geometry.gauss)[0]
        turns, bends = self.finger.rest(t.s)
        change.rest_turns[rows], change.rest_bends[rows] = turns, bends * t.flexible
        kinks, rates = self.finger.kinks()
        for kink, rate in zip(kinks, rates.T, strict=True):
            change.breaks[rows, _nearest(t, kink)] = rate
        face = t.piece <= UPPER
        if face.any():
            sign = (t.piece[face] - 0.5) * 1j
            thick, slope = self.finger.thickness(t.u[face])
            change.offsets[np.ix_(rows, face)] = sign * thick
            change.offset_slopes[np.ix_(rows, face)] = sign * slope
        if not face.all():
            starts, directions = self.finger.rigid()
            rigid = t.piece[~face] - (UPPER + 1)
            change.offsets[np.ix_(rows, ~face)] = starts[:, rigid] + t.u[~face] * directions[:, rigid]
            change.offset_slopes[np.ix_(rows, ~face)] = directions[:, rigid]

    def shift(self, frames: FrameRates) -> Shift:
        """What the numbers change for loads where the dimensionless finger stays."""
        going = np.array([float(key == MOTION) for key in self.keys])
        return Shift(frames.clamp_angle, going, self.log_length, self.log_force, self.log_energy)

    def rest(self, s: Array) -> Array:
        """Rates of the unloaded section's angle at fixed places s (k,), (p, k)."""
        out = np.zeros((len(self.keys), s.size))
        out[self._finger_rows] = self.finger.rest(s)[0]
        return out

    def _of_loads(self, t: Touching, change: Change, frames: FrameRates) -> None:
        """Loads change, and the places at which they act: there segments end."""
        first, shift = 0, self.shift(frames)
        held = {t.geometry.segments, *(_nearest(t, kink) for kink in self.setting.sections.kinks)}
        for bearing in t.carried.bearings:
            span = slice(first, first + bearing.s.size)
            first = span.stop
            change.load_forces[:, span], change.load_couples[:, span] = bearing.given(shift, self.rest(bearing.s))
            if bearing.spread_out:
                continue
            moving = -np.outer(self.log_length, bearing.s)
            moving[bearing.rate.rows] += bearing.rate.station_rates() / self.setting.sections.length
            for s, going in zip(bearing.s.tolist(), moving.T, strict=True):
                nearest = _nearest(t, s)
                if nearest in held and np.any(np.abs(going - change.breaks[:, nearest]) > _SAME):
                    rule = "act on the tip (s left out), or away from it, kinks and other loads, to be differentiated"
                    raise ValueError(f"a load must {rule}; got s = {s * self.setting.sections.length:.6g}")
                change.breaks[:, nearest] = going
                held.add(nearest)

    def _of_object(self, t: Touching, change: Change, frames: FrameRates) -> None:
        """The object moves, turns, is scaled by 1 / L, and changes its own shape."""
        change.gaps[:], change.normals[:] = self.passing(t.obstacle, frames, t.points)
        for span in t.spans:
            if span.site.kind == "vertex":
                change.vertices[:, span.queries.start] = self.corner(t.obstacle, frames, span.site.vertex)

    def passing(self, obstacle: Obstacle, frames: FrameRates, points: Complex) -> tuple[Array, Complex]:
        """Rates of g / L and grad g at points that stay, in the clamp's axes (k,): (p, k) each."""
        gap, normal, (a, b) = obstacle.curvature(points)
        arm = points - obstacle.frame.origin
        turning, stretch = frames.angle[:, None], self.log_length[:, None]
        moving = frames.origin[:, None] + 1j * turning * arm
        away = stretch * arm - moving
        gaps = stretch * (dot(normal, arm) - gap) - dot(normal, moving)
        normals = a * away + b * away.conj() + 1j * turning * normal
        g, gradient = self.object.at(obstacle.local(points))
        gaps[self._object_rows] += g / self.setting.sections.length
        normals[self._object_rows] += gradient * np.exp(1j * obstacle.frame.angle)
        return gaps, normals

    def corner(self, obstacle: Obstacle, frames: FrameRates, number: int) -> Complex:
        """Rates of a corner of the object, by L in the clamp's axes, (p,)."""
        out = obstacle.corners[number] - obstacle.frame.origin
        found: Complex = frames.origin + (1j * frames.angle - self.log_length) * out
        own = self.object.corners(self.setting.body.corners[number : number + 1])[:, 0]
        found[self._object_rows] += own * np.exp(1j * obstacle.frame.angle) / self.setting.sections.length
        return found

    def _of_friction(self, t: Touching, change: Change) -> None:
        for span in t.spans:
            grip = span.site.grip
            if grip is not None and grip.hold == "slip":
                change.ratios[:, span.queries] = -grip.sense * self.friction_rates(span.site)[:, None]

    def friction_rates(self, site: Site) -> Array:
        """Rates of mu at a contact, by each number."""
        friction, grip = self.scene.friction, site.grip
        if friction is None or grip is None:
            return np.zeros(len(self.keys))
        on, s = self.setting.outline.place(site.piece, np.array([site.middle if site.place else 1.0]))
        own = isinstance(friction.coefficient, Coefficients) and on == "jaw"
        mine = ("friction.coefficient", "friction.coefficient.jaw" if own else "friction.coefficient.finger")
        rates = np.array([float(key in mine) for key in self.keys])
        if own or not sympy.sympify(friction.finger).free_symbols:
            return rates
        place = float(s[0]) if site.on_face else 1.0
        steep = grip.law.at(LOWER, place)[1] * place  # at a fixed part of the length
        return rates + steep * self.log_length


def _nearest(t: Touching, s: float) -> int:
    """The end of a segment that is nearest to a place."""
    return int(np.argmin(np.abs(np.array(t.beam.breaks) - s)))
