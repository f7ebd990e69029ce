"""What the numbers of a scene change in the dimensionless problem of one pose: the directions of forward mode."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import sympy

from gripper.arrays import Array, Complex
from gripper.contact.kinematics import Kinematics
from gripper.contact.outline import LOWER, UPPER, dot
from gripper.contact.site import Site
from gripper.friction import Coefficients
from gripper.parameters import numbers
from gripper.scene import Scene
from gripper.sensitivity.finger_rates import FingerRates
from gripper.sensitivity.flow import Change
from gripper.sensitivity.memory import Memory
from gripper.sensitivity.object_rates import object_rates
from gripper.sensitivity.tangent import Rates, rates
from gripper.sensitivity.touching import Touching
from gripper.statics.equilibrium import Equilibrium, Setting

MOTION = "the motion's parameter"
_POSES = ("x", "y", "angle")


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
        self._solved: dict[int, Solved] = {}
        self.kinematics = Kinematics(scene, setting.sections.length)
        finger = {self._inner(key): known[key] for key in keys if self._table(key) == "finger"}
        body = {key.split(".", 1)[1]: known[key] for key in keys if self._table(key) == "object"}
        self.finger = FingerRates(setting.outline, finger)
        self.object = object_rates(setting.body, body)
        self._finger_rows = np.array([keys.index(self._outer(key)) for key in self.finger.keys], dtype=np.intp)
        self._object_rows = np.array([keys.index(f"object.{key}") for key in body], dtype=np.intp)
        self.log_length = self.spread(self.finger.log_length)
        self.log_stiffness = self.spread(self.finger.log_stiffness)

    @staticmethod
    def _table(key: str) -> str:
        head, *rest = key.split(".")
        if head == "material":
            return "finger"
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
        frame, turning = kinematics.frame(value), kinematics.turning(value)
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

    def _shifts(self, name: str) -> tuple[Complex, Array]:
        """Rates of a pose in the world: place and angle."""
        x, y, angle = (np.array([float(key == f"{name}.pose.{axis}") for key in self.keys]) for axis in _POSES)
        return x + 1j * y, angle

    def solved(self, equilibrium: Equilibrium) -> Solved:
        """The rates of an equilibrium by all numbers, reckoned once."""
        known = self._solved.get(id(equilibrium))
        if known is None:
            touching = Touching(self.setting, equilibrium, self.finger)
            frames = self.frames(equilibrium.obstacle.frame.parameter)
            known = Solved(touching, frames, rates(touching, self._change(touching, frames)))
            self._solved[id(equilibrium)] = known  # which keeps the equilibrium, and so its id
        return known

    def _change(self, touching: Touching, frames: FrameRates) -> Change:
        """The directions of all numbers at an equilibrium."""
        change = Change.none(touching, len(self.keys))
        self._of_finger(touching, change)
        self._of_object(touching, change, frames)
        self._of_friction(touching, change)
        self._memory.change(touching, change, frames)
        return change

    def _of_finger(self, t: Touching, change: Change) -> None:
        rows = self._finger_rows
        change.stiffness[rows] = t.stiffness[2]
        change.rest[rows] = self.finger.rest(t.beam.gauss)[0]
        turns, bends = self.finger.rest(t.s)
        change.rest_turns[rows], change.rest_bends[rows] = turns, bends * t.flexible
        kinks, rates = self.finger.kinks()
        for kink, rate in zip(kinks, rates.T, strict=True):
            nearest = int(np.argmin(np.abs(np.array(t.beam.breaks) - kink)))
            change.breaks[rows, nearest] = rate
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

    def _of_object(self, t: Touching, change: Change, frames: FrameRates) -> None:
        """The object moves, turns, is scaled by 1 / L, and changes its own shape."""
        obstacle, origin = t.obstacle, t.obstacle.frame.origin
        arm = t.points - origin
        turning, stretch = frames.angle[:, None], self.log_length[:, None]
        passing = frames.origin[:, None] + 1j * turning * arm
        change.gaps[:] = stretch * (dot(t.normal, arm) - t.gap) - dot(t.normal, passing)
        change.normals[:] = t.curved(stretch * arm - passing) + 1j * turning * t.normal
        g, gradient = self.object.at(obstacle.local(t.points))
        turn = cmath.exp(1j * obstacle.frame.angle)
        change.gaps[self._object_rows] += g / self.setting.sections.length
        change.normals[self._object_rows] += gradient * turn
        corners = self.object.corners() * turn / self.setting.sections.length
        for span in t.spans:
            if span.site.kind == "vertex":
                at, vertex = span.queries.start, span.site.vertex
                out = obstacle.corners[vertex] - origin
                change.vertices[:, at] = frames.origin + (1j * frames.angle - self.log_length) * out
                change.vertices[self._object_rows, at] += corners[:, vertex]

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
