"""Work against precision: every method at every resolution on one pose, beside a reference by shooting."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gripper.assemble import first_order, setting
from gripper.contact.kinematics import Kinematics
from gripper.motion.approach import approach
from gripper.scene import Scene
from gripper.statics.equilibrium import NoEquilibriumError
from gripper.study.cost import repeated, shifted, single_pose, start_up
from gripper.study.methods import Method, methods
from gripper.study.outcome import QUANTITIES, NoOutcomeError, errors, uncertainty
from gripper.study.shooting import shooting
from gripper.study.shot import NoReferenceError, Shot
from gripper.study.work import Work, WorkPrecision
from gripper.trace import trace

SHIFTS = (0.0, 0.0022, 0.0044, 0.0067, 0.0089)
"""Of the object along the finger, by L: over the spacing of 90 nodes, so that none is lucky."""
_FINE = 1e-9  # tolerance of the pose whose contacts the reference takes
Progress = Callable[[int, int], None]


def hardest(scene: Scene) -> float:
    """The parameter of the motion's pose with the largest contact force.

    Raises
    ------
    NoReferenceError
        No pose touches.
    """
    poses = [pose for pose in trace(scene).poses if pose.force_on_object and pose.parameter is not None]
    best = max(poses, key=lambda pose: np.hypot(*(pose.force_on_object or (0, 0))), default=None)
    if best is None or best.parameter is None or best.status != "contact":
        raise NoReferenceError("nothing touches along the motion: there is no force to compare")
    return best.parameter


def study(
    scene: Scene,
    at: float | None = None,
    *,
    quick: bool = False,
    repeats: int = 7,
    progress: Progress | None = None,
) -> WorkPrecision:
    """Measure every method on one pose of a scene, without friction.

    Parameters
    ----------
    scene
        What to solve; its theory is kept.
    at
        The motion's parameter; by default where the contact force is largest.
    quick
        Few resolutions, two shifts and one repeat: to see that it works.
    repeats
        Of each timed call, after a warm-up.
    progress
        Called after each point with the number done and their total.

    Raises
    ------
    NoReferenceError
        Nothing touches there, or the contacts are none that shooting knows.
    ValueError
        A parameter for a scene without motion.
    """
    notes = []
    if scene.friction is not None:
        scene, notes = replace(scene, friction=None), ["friction was left aside: the paper's scheme has none in it"]
    if scene.motion is not None:
        scene = single_pose(scene, hardest(scene) if at is None else at)
    elif at is not None:
        raise ValueError(f"at must be left out for a scene without motion; got {at!r}")
    places = [shifted(scene, d) for d in (SHIFTS[::4] if quick else SHIFTS)]
    shots = [reference(place) for place in places]
    entries = [(method, point) for method in methods(scene, quick=quick) for point in method.grid]
    works = []
    for done, (method, point) in enumerate(entries, start=1):
        works.append(_measure(method, point, places, [fine for fine, _ in shots], 1 if quick else repeats))
        if progress is not None:
            progress(done, len(entries))
    unsure = [uncertainty(*pair) for pair in shots]
    known = {name: max(each[name] for each in unsure) for name in QUANTITIES}
    return WorkPrecision(
        scene=scene,
        works=tuple(works),
        uncertainty=known,
        start_up=start_up(scene),
        repeats=1 if quick else repeats,
        shifts=len(places),
        notes=tuple(notes),
    )


def reference(scene: Scene) -> tuple[Shot, Shot]:
    """The answer by shooting for the contacts that this project finds, and a coarser one.

    Raises
    ------
    NoReferenceError
        There is none.
    """
    fine = replace(scene, tolerance=_FINE)
    fixed = setting(fine)
    frame = Kinematics(scene, fixed.sections.length).frame(0.0)
    try:
        answer, _ = approach(fixed, frame, scene.approach, first_order(_FINE))
    except NoEquilibriumError as error:
        raise NoReferenceError(f"which places touch is not known: {error}") from error
    return shooting(fixed, answer.verified.equilibrium)


def _measure(method: Method, point: float, places: list[Scene], shots: list[Shot], repeats: int) -> Work:
    began = time.process_time()
    label = f"{method.symbol} = {point:g}"
    found, failures = [], []
    try:
        ready = method.prepare(places[0], point)
    except (NoOutcomeError, ValueError) as error:
        return Work(method.name, label, 0, 0, 0, 0.0, None, None, {}, {}, (str(error),) * len(places))
    setup = time.process_time() - began
    outcomes = []
    for place, shot in zip(places, shots, strict=True):
        try:
            outcome = (ready if place is places[0] else method.prepare(place, point)).outcome()
        except (NoOutcomeError, NoEquilibriumError) as error:
            failures.append(str(error))
            continue
        outcomes.append(outcome)
        found.append(errors(outcome, shot))
    cold, _ = _timed(ready.cold, repeats)
    warm, warm_failure = _timed(ready.warm, repeats)
    return Work(
        method=method.name,
        point=label,
        unknowns=ready.unknowns,
        iterations=outcomes[0].iterations if outcomes else 0,
        evaluations=outcomes[0].evaluations if outcomes else 0,
        setup=setup,
        cold=cold,
        warm=warm,
        median={name: statistics.median(e[name] for e in found) for name in QUANTITIES if found},
        worst={name: max(e[name] for e in found) for name in QUANTITIES if found},
        failures=tuple(failures),
        warm_failure=warm_failure,
    )


def _timed(call: Callable[[], object] | None, repeats: int) -> tuple[float | None, str]:
    """Median CPU time of a call, and why there is none."""
    if call is None:
        return None, ""
    try:
        return repeated(call, repeats).median, ""
    except (NoOutcomeError, NoEquilibriumError) as error:
        return None, str(error)
