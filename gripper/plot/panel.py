"""One panel of a figure: the finger, or two, of one pose, and what its caption says."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from gripper.plot.draw import Key
from gripper.plot.sketch import Axis, Box, Sketch, extent, fingers, union
from gripper.plot.units import parameter_unit
from gripper.result import PoseResult, Result


class Panel(NamedTuple):
    """What a panel shows: the sketches of its fingers, none where the pose has no answer; the pose, and its name."""

    fingers: Sequence[Sketch]
    pose: PoseResult
    name: str

    @classmethod
    def of(cls, result: Result, i: int, name: str = "", mirror: Axis | None = None) -> Panel:
        """Gather pose i; it is called by the motion's parameter, after the name if it has one."""
        pose = result.poses[i]
        names = [name] if name else []
        if result.scene.motion is not None and pose.parameter is not None:
            unit = parameter_unit(result.scene)
            value = _number(unit.factor * round(pose.parameter, 12), ".4g")
            names.append(f"{result.parameter} = {value} {unit.name}".strip())
        return cls(fingers(result, i, mirror) if pose.shape is not None else [], pose, ", ".join(names))

    def caption(self, key: Key) -> str:
        """Name it, and say the force on the object, of each finger where there are two, or how it fared."""
        said: str = self.pose.status
        if self.pose.force_on_object and self.pose.status == "contact":
            force = _number(key.force.factor * math.hypot(*self.pose.force_on_object), "#.3g").rstrip(".")
            said = f"{force} {key.force.name}{' each' * (len(self.fingers) > 1)}"
        return f"{self.name}: {said}" if self.name else said

    def extent(self, key: Key) -> Box:
        """Give the box that holds it all, in m."""
        return union([extent(each, key.arrow) for each in self.fingers])


def _number(value: float, digits: str) -> str:
    return f"{value + 0.0:{digits}}".replace("-", "\N{MINUS SIGN}")
