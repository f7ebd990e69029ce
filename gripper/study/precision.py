"""Work against precision: every method at every resolution on one pose, beside a reference by shooting."""

from __future__ import annotations

import csv
import io
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gripper.assemble import first_order, setting
from gripper.equilibrium import NoEquilibriumError
from gripper.kinematics import Kinematics
from gripper.scene import Scene
from gripper.solve import approach
from gripper.study.cost import repeated, single_pose
from gripper.study.methods import Method, methods, shifted
from gripper.study.outcome import QUANTITIES, NoOutcomeError, errors, uncertainty
from gripper.study.shooting import NoReferenceError, Shot, shooting
from gripper.trace import trace

SHIFTS = (0.0, 0.0022, 0.0044, 0.0067, 0.0089)
"""Of the object along the finger, by L: over the spacing of 90 nodes, so that none is lucky."""
_FINER = 10.0  # how much finer than the best point the reference is to be
_FINE = 1e-9  # tolerance of the pose whose contacts the reference takes
Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Work:
    """One point of the diagram.

    Parameters
    ----------
    method, point
        Which method, and its resolution in words.
    unknowns, iterations, evaluations
        Of its optimiser; points at which g was evaluated.
    setup, cold, warm
        CPU time, in s: getting ready (a model that is built), a pose from nothing and from its neighbour's answer
        (medians); None where it failed.
    median, worst
        Errors by quantity over the shifts that were answered.
    failures
        Reasons, one a shift that was not answered.
    warm_failure
        Why the neighbour's answer leads nowhere; empty where it does.
    """

    method: str
    point: str
    unknowns: int
    iterations: int
    evaluations: int
    setup: float
    cold: float | None
    warm: float | None
    median: dict[str, float]
    worst: dict[str, float]
    failures: tuple[str, ...]
    warm_failure: str = ""


@dataclass(frozen=True)
class WorkPrecision:
    """A work-precision study of one pose.

    Parameters
    ----------
    scene
        Of one pose.
    works
        In the order of the methods.
    uncertainty
        Of the reference, by quantity: errors below it mean nothing.
    start_up
        CPU time, in s, of an interpreter that imports gripper, and of compiling this finger and object.
    repeats, shifts
        How often each call was timed, and how many places of the object the errors are over.
    notes
        What was left aside.
    """

    scene: Scene
    works: tuple[Work, ...]
    uncertainty: dict[str, float]
    start_up: tuple[float, float]
    repeats: int
    shifts: int
    notes: tuple[str, ...]

    def csv(self) -> str:
        """Write one row a point, units in the column names; empty cells where there is no answer."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        pairs = [f"{name}_error_{kind}" for name in QUANTITIES for kind in ("median", "worst")]
        times = ["setup_ms", "cold_ms", "warm_ms"]
        writer.writerow(["method", "point", "unknowns", "iterations", "evaluations", *times, *pairs, "failed", "why"])
        for work in self.works:
            cells = [f"{1e3 * t:.4g}" if t is not None else "" for t in (work.setup, work.cold, work.warm)]
            for name in QUANTITIES:
                cells += [f"{d[name]:.3e}" if name in d else "" for d in (work.median, work.worst)]
            counts = [work.unknowns, work.iterations, work.evaluations]
            warm = [f"warm: {work.warm_failure}"] if work.warm_failure else []
            reasons = "; ".join(dict.fromkeys([*work.failures, *warm]))
            writer.writerow([work.method, work.point, *counts, *cells, len(work.failures), reasons])
        return text.getvalue()

    def table(self) -> str:
        """Write the points as a Markdown table."""
        head = (
            "| method | at | unknowns | iterations | set-up ms | cold ms | warm ms | force | energy | place | depth |"
        )
        lines = [head, "|---" * 11 + "|"]
        for work in self.works:
            times = [f"{1e3 * t:.3g}" if t is not None else "" for t in (work.setup, work.cold, work.warm)]
            if not work.median:
                cells = ["failed", "", "", ""]
            else:
                cells = [_spread(work.median[n], work.worst[n]) for n in ("force", "energy", "place", "depth")]
            failed = f" ({len(work.failures)} of {self.shifts} failed)" if work.failures and work.median else ""
            times[2] = "failed" if work.warm_failure else times[2]
            counts = [str(work.unknowns), str(work.iterations)]
            lines.append("| " + " | ".join([work.method + failed, work.point, *counts, *times, *cells]) + " |")
        return "\n".join(lines)

    def __str__(self) -> str:
        known = ", ".join(f"{name} {value:.0e}" for name, value in self.uncertainty.items() if name != "depth")
        begun, compiled = self.start_up
        text = [
            f"errors as median (worst) over {self.shifts} places of the object; CPU time as median of {self.repeats}",
            "force and energy relative, place of contact and depth by L",
            f"reference: shooting, uncertain by: {known}",
            f"once an interpreter: {begun:.2f} s to import, {1e3 * compiled:.0f} ms to compile finger and object",
            *self.notes,
        ]
        return "\n".join([self.table(), "", *text])


def _spread(median: float, worst: float) -> str:
    return f"{median:.0e} ({worst:.0e})" if worst else "0"


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
    notes += _unresolved(works, known)
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


def _unresolved(works: list[Work], known: dict[str, float]) -> list[str]:
    """Say where the reference is not ten times finer than the best point."""
    names = []
    for name in ("force", "energy", "place", "shape"):
        best = min((work.median[name] for work in works if work.median), default=1.0)
        if best < _FINER * known[name]:
            names.append(name)
    return [f"the best points are too good for the reference to tell ({', '.join(names)})"] if names else []


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


_START_UP = """
import time
begun = time.process_time()
import gripper
imported = time.process_time()
import pickle, sys
scene = pickle.load(sys.stdin.buffer)
times = [time.process_time()]
for _ in range(2):
    gripper.solve(scene)
    times.append(time.process_time())
print(imported, times[1] - times[0] - (times[2] - times[1]))
"""


def start_up(scene: Scene) -> tuple[float, float]:
    """CPU seconds of a fresh interpreter until gripper is imported, and of compiling a scene's finger and object."""
    import pickle

    done = subprocess.run([sys.executable, "-c", _START_UP], input=pickle.dumps(scene), capture_output=True, check=True)
    imported, compiled = map(float, done.stdout.split())
    return imported, max(compiled, 0.0)
