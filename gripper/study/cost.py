"""Measuring what a call costs, and making the single pose of a motion that is measured."""

from __future__ import annotations

import pickle
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np

from gripper.contact.kinematics import Kinematics
from gripper.pose import Pose, placed
from gripper.scene import Scene

Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Repeated(Generic[Answer]):
    """A call that was repeated.

    Parameters
    ----------
    seconds
        CPU time of each repeat, all threads of the process together.
    answers
        What each returned.
    """

    seconds: tuple[float, ...]
    answers: tuple[Answer, ...]

    @property
    def median(self) -> float:
        """Median CPU time, in s."""
        return statistics.median(self.seconds)

    @property
    def least(self) -> float:
        """Least CPU time, in s."""
        return min(self.seconds)


def repeated(call: Callable[[], Answer], repeats: int = 7) -> Repeated[Answer]:
    """Measure a call after one warm-up, which compiles what is compiled once.

    Set the BLAS library to one thread before numpy is imported: its waiting threads burn CPU time too.

    Raises
    ------
    ValueError
        Fewer than one repeat.
    """
    if repeats < 1:
        raise ValueError(f"repeats must be at least 1; got {repeats!r}")
    call()
    seconds, answers = [], []
    for _ in range(repeats):
        began = time.process_time()
        answers.append(call())
        seconds.append(time.process_time() - began)
    return Repeated(tuple(seconds), tuple(answers))


def single_pose(scene: Scene, parameter: float) -> Scene:
    """Make the scene of one pose of a motion: numbers for poses, no motion.

    Parameters
    ----------
    scene
        With a motion.
    parameter
        Value of its parameter.

    Raises
    ------
    ValueError
        A pose that is not finite there.
    """
    finger, body = placed(scene.finger), placed(scene.object)
    places = Kinematics(scene, finger.body.length).placement(parameter)
    clamp, other = (Pose(x=x, y=y, angle=angle) for x, y, angle in (places.clamp, places.object))
    return replace(scene, finger=replace(finger, pose=clamp), object=replace(body, pose=other), motion=None)


def shifted(scene: Scene, distance: float) -> Scene:
    """The scene of one pose with its object moved along the undeflected finger, by a part of L."""
    finger, target = placed(scene.finger), placed(scene.object)
    angle, step = float(finger.pose.angle), distance * finger.body.length
    pose = replace(target.pose, x=target.pose.x + step * np.cos(angle), y=target.pose.y + step * np.sin(angle))
    return replace(scene, object=replace(target, pose=pose))


_START_UP = """
import time
begun = time.process_time()
from gripper import solve
imported = time.process_time()
import pickle, sys
scene = pickle.load(sys.stdin.buffer)
times = [time.process_time()]
for _ in range(2):
    solve(scene)
    times.append(time.process_time())
print(imported, times[1] - times[0] - (times[2] - times[1]))
"""


def start_up(scene: Scene) -> tuple[float, float]:
    """CPU seconds of a fresh interpreter until gripper is imported, and of compiling a scene's finger and object."""
    done = subprocess.run([sys.executable, "-c", _START_UP], input=pickle.dumps(scene), capture_output=True, check=True)
    imported, compiled = map(float, done.stdout.split())
    return imported, max(compiled, 0.0)
