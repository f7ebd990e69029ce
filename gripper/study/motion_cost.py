"""What the poses of a motion cost, beside the paper's own scheme on the same poses."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from math import dist, hypot
from statistics import median
from typing import NamedTuple

from gripper.assemble import setting
from gripper.scene import Scene
from gripper.solve import solve
from gripper.study.cost import repeated, single_pose
from gripper.study.precision import reference
from gripper.study.published import solve_as_published
from gripper.trace import trace

Vector = tuple[float, float]
Pair = tuple[Sequence[float], Sequence[float]]
"""CPU times of this project's repeats and of the paper's scheme's, in s."""


class Cost(NamedTuple):
    """One row; the force's relative error is the largest of the places' where it stands for several."""

    theory: str
    what: str
    cpu_ms_median: float
    cpu_ms_min: float
    paper_over_this: float
    force_error: float

    def __str__(self) -> str:
        return "{:8} {:45} {:14.1f} {:8.1f} {:11.1f} {:12.1e}".format(*self)


HEAD = f"{'theory':8} {'what':45} {'CPU ms: median':>14} {'min':>8} {'paper/this':>11} {'force error':>12}"
"""Of a table of costs."""


def costs(scene: Scene, places: Sequence[float], repeats: int = 7) -> Iterator[Cost]:
    """Measure some poses alone, a motion that passes through them, and all its poses in contact alone.

    Errors are by shooting, of the poses named.

    Parameters
    ----------
    scene
        A motion; its theory is bending or shear.
    places
        Values of the parameter.
    repeats
        Of each, after a warm-up.
    """
    published = partial(solve_as_published, scene, N=90, shear="none" if scene.theory == "bending" else "element")
    known = {place: _exact(single_pose(scene, place)) for place in places}
    row = partial(_rows, scene.theory)
    for place, exact in known.items():
        ours, paper = (
            repeated(partial(solve, single_pose(scene, place)), repeats),
            repeated(partial(published, place), repeats),
        )
        forces = ours.answers[0].poses[0].force_on_object_finger_frame, paper.answers[0].force_on_object
        yield from row(
            f"cold pose {_parameter(scene)} = {place}",
            (ours.seconds, paper.seconds),
            [_error(f, exact) for f in forces],
        )

    values = scene.motion.values if scene.motion else ()
    whole, each = (
        repeated(lambda: trace(scene).poses, repeats),
        repeated(lambda: [published(v) for v in values], repeats),
    )
    at = {min(range(len(values)), key=lambda i: abs(values[i] - place)): exact for place, exact in known.items()}
    errors = [
        max(_error(whole.answers[0][i].force_on_object_finger_frame, exact) for i, exact in at.items()),
        max(_error(each.answers[0][i].force_on_object, exact) for i, exact in at.items()),
    ]
    touching = [i for i, pose in enumerate(whole.answers[0]) if pose.status == "contact"]
    alone = [repeated(partial(solve, single_pose(scene, values[i])), repeats).seconds for i in touching]
    paper_alone = [[run[i].seconds for run in each.answers] for i in touching]
    ranked = [sorted(poses, key=median) for poses in (alone, paper_alone)]  # by what each pose costs
    for what, i in (("median", len(touching) // 2), ("slowest", -1)):
        yield from row(f"{what} of {len(touching)} cold poses in contact", (ranked[0][i], ranked[1][i]), errors)
    mine = [median(run[i].seconds for i in touching) for run in whole.answers]
    theirs = [median(run[i].seconds for i in touching) for run in each.answers]
    yield from row("median warm pose in contact", (mine, theirs), errors)
    yield from row(f"all {len(values)} poses", (whole.seconds, each.seconds), errors)


def _rows(theory: str, what: str, seconds: Pair, errors: Sequence[float]) -> Iterator[Cost]:
    """Give the rows of this project and of the paper's scheme."""
    for name, cpu, off in zip(("gripper", "the paper's scheme"), seconds, errors, strict=True):
        yield Cost(theory, f"{what}, {name}", 1e3 * median(cpu), 1e3 * min(cpu), median(seconds[1]) / median(cpu), off)


def _parameter(scene: Scene) -> str:
    return scene.motion.parameter if scene.motion else "pose"


def _exact(scene: Scene) -> Vector:
    """The force on the object by shooting, in N, finger frame."""
    force = -reference(scene)[0].force * setting(scene).sections.force_scale
    return force.real, force.imag


def _error(force: Vector | None, exact: Vector) -> float:
    return 1.0 if force is None else dist(force, exact) / hypot(*exact)
