"""One pose on paper: what is drawn of it, and where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gripper.objects import Object
from gripper.plot.load import Pull, pulls, reach
from gripper.pose import placed
from gripper.result import Contact, PoseResult, Result, Shape

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""Left, bottom, right, top, in m."""
Axis = tuple[float, float, float]
"""A straight line in the world: a point x, y (m) on it, and its direction (rad)."""

_MARGIN = 0.06
_SAMPLES = 200
_LARGE = 2.5
"""An object larger than this many fingers is drawn where the finger is, not whole."""
_SYMMETRIC = 2e-3
"""How far an object's outline may lie from its own mirror image, as a part of its size: a drawn line's width."""


class Arrow(NamedTuple):
    """A contact on paper: its point (2,), the force on the object there (2,) in N, and whether it sticks."""

    point: Array
    force: Array
    sticks: bool


@dataclass(frozen=True)
class Sketch:
    """What one finger of one pose puts on paper: lengths in m, world frame.

    Parameters
    ----------
    pose, shape
        The answer.
    outline
        The object's polylines, (m, 2) each; none for a second finger.
    whole
        Whether they are all of it; else it goes on beyond them.
    inside
        Points (k, k, 2) and g (k, k) where the object has no bounds or several outlines; else None.
    arrows
        The contacts and their forces.
    pulls
        What else loads the finger.
    """

    pose: PoseResult
    shape: Shape
    outline: list[Array]
    whole: bool
    inside: tuple[Array, Array] | None
    arrows: list[Arrow]
    pulls: list[Pull]

    @property
    def wall(self) -> Array:
        """Corners (4, 2) of the wall behind the clamped section."""
        section = self.shape.upper[0] - self.shape.lower[0]
        thickness = float(np.linalg.norm(section))
        across = section / thickness * max(0.75 * thickness, 0.06 * self.size)
        behind = np.array([-section[1], section[0]]) / thickness * max(0.5 * thickness, 0.045 * self.size)
        if behind @ (self.shape.axis[1] - self.shape.axis[0]) > 0:
            behind = -behind
        ends = np.array([-across, across])
        return np.concatenate([self.shape.axis[0] + ends, self.shape.axis[0] + ends[::-1] + behind])

    @property
    def body(self) -> Array:
        """Every vertex of finger, jaw and wall, (n, 2)."""
        jaw = [] if self.shape.jaw is None else [self.shape.jaw]
        return np.concatenate([self.shape.outline, self.wall, *jaw])

    @property
    def size(self) -> float:
        """The finger's length on paper, in m."""
        return float(np.linalg.norm(np.diff(self.shape.axis, axis=0), axis=1).sum())


def sketch(result: Result, i: int) -> Sketch:
    """Gather what pose i, which must have a shape, puts on paper."""
    answer = result.poses[i]
    assert answer.shape is not None, "a pose without an answer has no shape"
    shape, target = answer.shape, placed(result.scene.object).body
    box = _surroundings(shape)
    own = target.outline(box)
    outline = [_moved(piece, *shape.object_pose) for piece in own]
    bounded = bool(np.isfinite(target.box).all())
    inside = None if bounded and len(own) == 1 else _inside(target, target.box if bounded else box, shape)
    size = float(np.linalg.norm(np.diff(shape.axis, axis=0), axis=1).sum())
    return Sketch(answer, shape, outline, bounded, inside, _arrows(answer, shape), pulls(result, i, size))


def fingers(result: Result, i: int, mirror: Axis | None = None) -> list[Sketch]:
    """Gather pose i: the finger and the object and, given an axis of the object's symmetry, a second finger.

    Raises
    ------
    ValueError
        The object's outline has not that symmetry.
    """
    first = sketch(result, i)
    return [first] if mirror is None else [first, _reflected(first, mirror, placed(result.scene.object).body)]


def _reflected(first: Sketch, axis: Axis, target: Object) -> Sketch:
    x, y, angle = axis
    cos, sin = math.cos(2 * angle), math.sin(2 * angle)
    turn = np.array([[cos, sin], [sin, -cos]])

    def across(points: Array) -> Array:
        return np.asarray((points - (x, y)) @ turn + (x, y), dtype=float)

    _check_symmetric(first, np.concatenate([across(piece) for piece in first.outline]), target, axis)
    shape = first.shape
    jaw = None if shape.jaw is None else across(shape.jaw)
    shape = replace(shape, axis=across(shape.axis), lower=across(shape.lower), upper=across(shape.upper), jaw=jaw)
    arrows = [Arrow(across(point), force @ turn, sticks) for point, force, sticks in first.arrows]
    other = [Pull(across(pull.point), pull.direction @ turn, -pull.turn) for pull in first.pulls]
    return replace(first, shape=shape, outline=[], inside=None, arrows=arrows, pulls=other)


def _check_symmetric(first: Sketch, image: Array, target: Object, axis: Axis) -> None:
    x, y, angle = first.shape.object_pose
    own = _moved(image - (x, y), 0.0, 0.0, -angle)
    off = float(np.abs(target.gap(own)).max())
    if off > _SYMMETRIC * float(np.ptp(image, axis=0).max()):
        raise ValueError(
            f"mirror must be an axis of symmetry of the object, as x, y in m and an angle in rad; got {axis!r}, "
            f"beyond which its outline lies {off:.3g} m off"
        )


def _moved(points: Array, x: float, y: float, angle: float) -> Array:
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    return np.asarray(points @ turn.T + (x, y), dtype=float)


def _surroundings(shape: Shape) -> Box:
    """Give a box, in the object's own frame, that holds all of the world that may be drawn."""
    reach = 2 * float(np.ptp(shape.axis, axis=0).max())
    low, high = shape.axis.min(axis=0) - reach, shape.axis.max(axis=0) + reach
    x, y, angle = shape.object_pose
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    own = _moved(corners - (x, y), 0.0, 0.0, -angle)
    return (*own.min(axis=0).tolist(), *own.max(axis=0).tolist())


def _inside(target: Object, box: Box, shape: Shape) -> tuple[Array, Array]:
    """Sample g, for an object that its outline's polygon alone does not show: without bounds, or with a hole."""
    sides = np.meshgrid(np.linspace(box[0], box[2], _SAMPLES), np.linspace(box[1], box[3], _SAMPLES))
    own = np.stack(sides, axis=-1)
    return _moved(own, *shape.object_pose), target.gap(own.reshape(-1, 2)).reshape(_SAMPLES, _SAMPLES)


def _arrows(answer: PoseResult, shape: Shape) -> list[Arrow]:
    contacts = answer.contacts
    if len(contacts) == 1 and answer.force_on_object is not None:
        forces = [np.array(answer.force_on_object)]
    else:
        forces = [_force(contact, shape) for contact in contacts]
    return [Arrow(np.array(c.point), force, c.state == "stick") for c, force in zip(contacts, forces, strict=True)]


def _force(contact: Contact, shape: Shape) -> Array:
    """Give the force on the object: against the outward normal, and friction along the face towards the tip."""
    steps = np.diff(shape.axis, axis=0)
    nearest = int(np.argmin(np.linalg.norm(shape.axis[1:] - contact.point, axis=1)))
    normal = np.array(contact.normal)
    tangent = np.array([-normal[1], normal[0]])
    towards_tip = tangent if tangent @ steps[nearest] > 0 else -tangent
    return np.asarray(contact.tangential_force * towards_tip - contact.normal_force * normal, dtype=float)


def extent(drawn: Sketch, arrow: float) -> Box:
    """Give the box that holds finger, jaw, arrows (m a N) and, unless it is far larger than the finger, the object."""
    heads = [each.point + arrow * each.force for each in drawn.arrows]
    points = [drawn.body, *(head[np.newaxis] for head in heads), *(reach(pull, drawn.size) for pull in drawn.pulls)]
    outline = np.concatenate(drawn.outline) if drawn.outline else drawn.body
    if drawn.whole and float(np.ptp(outline, axis=0).max()) < _LARGE * drawn.size:
        points.append(outline)
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    margin = _MARGIN * max(drawn.size, float((high - low).max()))
    return (*(low - margin), *(high + margin))


def union(boxes: Sequence[Box]) -> Box:
    """Give the box that holds them all."""
    left, bottom, right, top = zip(*boxes, strict=True)
    return min(left), min(bottom), max(right), max(top)
