"""Where the object is, seen from the clamp, along a scene's motion, and the way there; read from the scene alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import sympy

from gripper.objects import Array
from gripper.pose import placed
from gripper.scene import Motion, Scene


@dataclass(frozen=True)
class Frame:
    """A frame in another one, such as the object's in the clamp's: origin in m, angle in rad."""

    x: float
    y: float
    angle: float

    @property
    def turn(self) -> Array:
        """Rotation matrix from its axes to the outer ones, (2, 2)."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, -s], [s, c]])

    def local(self, points: Array) -> Array:
        """Outer points (n, 2), in this frame."""
        return (points - np.array([self.x, self.y])) @ self.turn

    def place(self, points: Array) -> Array:
        """Points (n, 2) of this frame, in the outer one."""
        return np.asarray(points @ self.turn.T + np.array([self.x, self.y]))

    def shifted(self, direction: tuple[float, float], distance: float) -> Frame:
        """The frame moved along an outer unit direction by a distance in m."""
        return Frame(self.x + direction[0] * distance, self.y + direction[1] * distance, self.angle)


Path = Callable[[float], Frame]
"""From a parameter to the object's frame."""


def _world(scene: Scene) -> Callable[[float], tuple[Frame, Frame]]:
    """The frames of clamp and object in the world, at a value of the motion's parameter."""
    poses = placed(scene.finger).pose, placed(scene.object).pose
    q = sympy.Symbol("q")
    raw = [sympy.sympify(value) for pose in poses for value in (pose.x, pose.y, pose.angle)]
    function = sympy.lambdify([q], [e.subs({symbol: q for symbol in e.free_symbols}) for e in raw], "math")

    def frames(value: float) -> tuple[Frame, Frame]:
        numbers = [float(v) for v in function(value)]
        if not np.all(np.isfinite(numbers)):
            raise ValueError(f"poses must be finite at every pose; got {numbers} at {value!r}")
        return Frame(*numbers[:3]), Frame(*numbers[3:])

    return frames


def relative(scene: Scene) -> Path:
    """The object's frame in the clamp's, at a value of the motion's parameter (any value without a motion)."""
    frames = _world(scene)

    def frame(value: float) -> Frame:
        clamp, body = frames(value)
        x, y = clamp.local(np.array([[body.x, body.y]]))[0]
        return Frame(float(x), float(y), body.angle - clamp.angle)

    return frame


def clamp(scene: Scene, value: float) -> Frame:
    """The clamp's frame in the world."""
    return _world(scene)(value)[0]


def travel(start: Frame, stop: Frame, reach: float) -> float:
    """How far the object's matter moves at most within this reach (m) of its origin, in m."""
    return float(np.hypot(stop.x - start.x, stop.y - start.y) + reach * abs(stop.angle - start.angle))


def passing(motion: Motion | None, poses: Sequence[float] | None) -> tuple[list[float], list[bool]]:
    """Values of a motion's parameter to visit, and which of them are asked for: its start, every turn, and the poses.

    Raises
    ------
    ValueError
        Poses that the motion does not pass in this order (any order will do where it goes one way).
    """
    if motion is None:
        if poses is not None:
            raise ValueError(f"poses must be left out for a scene without motion; got {list(poses)!r}")
        return [0.0], [True]
    if poses is None:
        return list(motion.values), [True] * len(motion.values)
    turns = _turns(motion.values)
    asked = sorted(poses, reverse=turns[-1] < turns[0]) if len(turns) <= 2 else list(poses)
    if not asked:
        raise ValueError("poses must hold at least one value; got none")
    way = list(_passed(turns, asked))
    if asked:
        marks = " to ".join(f"{value:.6g}" for value in turns) + (", in its order" if len(turns) > 2 else "")
        raise ValueError(f"poses must be values that the motion passes, {marks}; got {asked[0]!r}")
    if len(way) == 1 < len(turns):  # where the motion goes on to decides how the first pose slides
        way.append((motion.values[1], False))
    return [value for value, _ in way], [wanted for _, wanted in way]


def _turns(values: Sequence[float]) -> list[float]:
    """The first and last of these values, and those where they turn."""
    kept = list(values[:1])
    for before, value, after in zip(values, values[1:], [*values[2:], None], strict=False):
        if after is None or (value - before) * (after - value) <= 0:
            kept.append(value)
    return kept


def _passed(turns: Sequence[float], asked: list[float]) -> Iterator[tuple[float, bool]]:
    """The way along these values through those asked for, which are taken off the list."""
    at_start = asked[0] == turns[0]
    yield (asked.pop(0) if at_start else turns[0]), at_start
    for before, after in pairwise(turns):
        low, high = min(before, after), max(before, after)
        while asked and low <= asked[0] <= high and asked[0] != before:
            before = asked.pop(0)
            low, high = min(before, after), max(before, after)
            yield before, True
        if not asked:
            return
        if before != after:
            yield after, False
