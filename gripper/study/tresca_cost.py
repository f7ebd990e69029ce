"""This project's friction beside Tresca problems, on the same poses: how far apart, and at what cost."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from statistics import median
from typing import NamedTuple

from gripper.contact.kinematics import Kinematics
from gripper.scene import Motion, Scene
from gripper.study.tresca import Tresca
from gripper.trace import trace


class Compared(NamedTuple):
    """One spacing of the poses; times are CPU times a pose, the force is Tresca's against this project's, at worst."""

    spacing_mm: float
    tresca_ms: float
    rounds: float
    force_difference: float
    gripper_ms: float

    def __str__(self) -> str:
        return "| {:.2f} | {:.0f} | {:.1f} | {:.1e} | {:.1f} |".format(*self)


HEAD = """| poses apart, mm | Tresca, ms a pose | rounds | force against this project's | this project, ms a pose |
|---|---|---|---|---|"""
"""Of a table of these."""


def compared(scene: Scene, values: Sequence[float]) -> Compared:
    """Measure both on the same poses, after the way of the scene's motion to the first of them.

    Parameters
    ----------
    scene
        With friction, theory bending, and a motion along a length: its first value is where the way begins.
    values
        Evenly spaced values of the parameter, in m, at which one contact on a smooth stretch slips or sticks.

    Raises
    ------
    ValueError
        Other contacts than that, a pose without an answer, or a scene without motion.
    """
    if scene.motion is None:
        raise ValueError("scene must have a motion, whose first value is where the way begins; got none")
    ours = trace(replace(scene, motion=Motion(scene.motion.parameter, (scene.motion.values[0], *values))))
    for pose in ours.poses:
        if pose.status in ("failed", "locked"):
            raise ValueError(f"values must be of poses with an answer; got {pose.parameter}: {pose.reason}")
    first, *poses = ours.poses[1:]
    assert first.kept is not None, "solved in this process"
    setting = first.kept.setting
    path, tresca = Kinematics(scene, setting.sections.length), Tresca(setting, first.kept.equilibrium)
    began = time.process_time()
    found = [tresca.pose(setting.obstacle(path.frame(value))) for value in values[1:]]
    seconds = (time.process_time() - began) / len(found)
    held = [pose.force_on_object_finger_frame for pose in poses]
    forces = [complex(*force) for force in held if force is not None]
    off = max(abs(its.force - force) / abs(force) for its, force in zip(found, forces, strict=True))
    rounds = sum(its.rounds for its in found) / len(found)
    spacing = 1e3 * abs(values[1] - values[0])
    return Compared(spacing, 1e3 * seconds, rounds, off, 1e3 * median(pose.seconds for pose in poses))
