"""The model ladder: the same poses by every theory, from the handbook's formula to finite elements."""

from __future__ import annotations

import csv
import io
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from gripper.result import Result
from gripper.scene import Motion, Scene
from gripper.solve import solve
from gripper.statics.ladder import RUNGS
from gripper.study.line_model import as_line
from gripper.study.small import NoModelError, Small, handbook, linear
from gripper.trace import trace
from gripper.verify import verify

Vector = tuple[float, float]
Progress = Callable[[int, int], None]
ELEMENTS, COARSE = (72, 8), (24, 4)
ELEMENTS_NAME = "finite elements"


@dataclass(frozen=True)
class Rung:
    """One theory at one pose.

    Parameters
    ----------
    model
        Which theory.
    parameter
        The motion's; None without one.
    force
        On the object, in N, clamp's axes; None where there is none.
    difference
        Distance from the finite elements' force, relative to it; None where either is missing.
    seconds
        CPU time of the pose.
    why
        Why there is no force.
    """

    model: str
    parameter: float | None
    force: Vector | None
    difference: float | None
    seconds: float | None
    why: str = ""


@dataclass(frozen=True)
class Ladder:
    """All theories at some poses of a scene."""

    scene: Scene
    rungs: tuple[Rung, ...]
    elements: tuple[int, int]
    mesh_error: float | None

    def csv(self) -> str:
        """Write one row a theory and pose, units in the column names; empty cells where there is no answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        name = self.scene.motion.parameter if self.scene.motion else "pose"
        columns = ["model", "force_on_object_x_N", "force_on_object_y_N", "difference_to_elements", "cpu_ms", "why"]
        writer.writerow([name, *columns])
        for rung in self.rungs:
            force = rung.force or ("", "")
            rest = ["" if v is None else v for v in (rung.difference, rung.seconds and 1e3 * rung.seconds)]
            writer.writerow([0 if rung.parameter is None else rung.parameter, rung.model, *force, *rest, rung.why])
        return text.getvalue()

    def __str__(self) -> str:
        name = self.scene.motion.parameter if self.scene.motion else "pose"
        lines = [f"| {name} | model | Fx N | Fy N | from the elements | CPU ms |", "|---|---|---|---|---|---|"]
        for rung in self.rungs:
            place = "" if rung.parameter is None else f"{rung.parameter:.6g}"
            if rung.force is None:
                lines.append(f"| {place} | {rung.model} | | | {rung.why} | |")
                continue
            away = "" if rung.difference is None or rung.model == ELEMENTS_NAME else _percent(rung.difference)
            force = " | ".join(f"{value + 0.0:.4g}" for value in rung.force)
            lines.append(f"| {place} | {rung.model} | {force} | {away} | {1e3 * (rung.seconds or 0):.3g} |")
        along, across = self.elements
        mesh = "" if self.mesh_error is None else f", their mesh error below {100 * self.mesh_error:.2g} %"
        note = f"force of the finger on the object, clamp's axes; elements: {along} x {across} quadratic{mesh}"
        note += "\ntime: of the pose, the first one with its approach"
        return "\n".join([*lines, "", note])


def models(
    scene: Scene, at: Sequence[float] | None = None, *, quick: bool = False, progress: Progress | None = None
) -> Ladder:
    """Solve some poses of a scene by every theory, without friction.

    Parameters
    ----------
    scene
        What to solve.
    at
        Values of the motion's parameter in its order; by default three of its poses in contact.
    quick
        A coarse mesh.
    progress
        Called after each model with the number done and their total.

    Raises
    ------
    ValueError
        Values without a motion, or none that touches.
    """
    scene = replace(scene, friction=None)
    if scene.motion is None and at is not None:
        raise ValueError(f"at must be left out for a scene without motion; got {list(at)!r}")
    places = _places(scene, at)
    elements = COARSE if quick else ELEMENTS
    steps: list[Callable[[], list[Rung]]] = [
        partial(_small, "handbook formula", handbook, scene, places),
        partial(_small, "small deflections", linear, scene, places),
        partial(_solved, "finger as a line", replace(as_line(scene), theory="bending"), places),
        *(partial(_solved, theory, replace(scene, theory=theory), places) for theory in RUNGS),
    ]
    found: list[Rung] = []
    for done, step in enumerate(steps, start=1):
        found += step()
        if progress is not None:
            progress(done, len(steps) + 1)
    known, mesh_error = _elements(scene, places, elements)
    if progress is not None:
        progress(len(steps) + 1, len(steps) + 1)
    true = {rung.parameter: rung.force for rung in known}
    compared = [replace(rung, difference=_apart(rung.force, true[rung.parameter])) for rung in [*found, *known]]
    ordered = [rung for place in places for rung in compared if rung.parameter == place]
    return Ladder(scene, tuple(ordered), elements, mesh_error)


def _places(scene: Scene, at: Sequence[float] | None) -> list[float | None]:
    if scene.motion is None:
        return [None]
    if at is not None:
        return list(at)
    touching = [pose.parameter for pose in trace(scene).poses if pose.status == "contact"]
    if not touching:
        raise ValueError(f"scene must have a pose in contact; got none along {scene.motion.parameter!r}")
    return [touching[(len(touching) - 1) * i // 4] for i in (1, 2, 3)] if len(touching) > 2 else touching


def _small(
    name: str, model: Callable[[Scene, float | None], Small], scene: Scene, places: list[float | None]
) -> list[Rung]:
    out = []
    for place in places:
        try:
            model(scene, place)  # compiles what is compiled once
            began = time.process_time()
            force = model(scene, place).force
        except NoModelError as error:
            out.append(Rung(name, place, None, None, None, str(error)))
            continue
        out.append(Rung(name, place, (force.real, force.imag), None, time.process_time() - began))
    return out


def _solved(name: str, scene: Scene, places: list[float | None]) -> list[Rung]:
    _result(scene, places)  # compiles what is compiled once
    out = []
    for place, pose in zip(places, _result(scene, places).poses, strict=True):
        why = pose.reason or ""
        out.append(Rung(name, place, pose.force_on_object_finger_frame, None, pose.seconds, why))
    return out


def _result(scene: Scene, places: list[float | None]) -> Result:
    values = [place for place in places if place is not None]
    if scene.motion is None:
        return solve(scene)
    return trace(replace(scene, motion=Motion(scene.motion.parameter, tuple(values))))


def _elements(scene: Scene, places: list[float | None], elements: tuple[int, int]) -> tuple[list[Rung], float | None]:
    values = [place for place in places if place is not None] or None
    moving = scene
    if scene.motion is not None and values is not None:
        passed = tuple(dict.fromkeys((scene.motion.values[0], *values)))
        moving = replace(scene, motion=Motion(scene.motion.parameter, passed))
    report = verify(moving, values, elements=elements)
    out = []
    for place, pose in zip(places, report.poses, strict=True):
        found = pose.elements
        out.append(Rung(ELEMENTS_NAME, place, found.force, None, found.seconds, found.reason or ""))
    errors = [pose.mesh_error for pose in report.poses if pose.mesh_error is not None]
    return out, max(errors, default=None)


def _percent(value: float) -> str:
    return f"{100 * value:.2g} %" if value < 0.1 else f"{100 * value:.0f} %"


def _apart(force: Vector | None, true: Vector | None) -> float | None:
    if force is None or true is None or math.hypot(*true) == 0:
        return None
    return math.dist(force, true) / math.hypot(*true)
