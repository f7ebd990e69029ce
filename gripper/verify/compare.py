"""The second opinion: elements on two meshes, beside gripper's own result."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from gripper.result import PoseResult, Result
from gripper.scene import Motion, Scene
from gripper.verify.friction import Friction, check
from gripper.verify.material import LAWS, LawName
from gripper.verify.mesh import JawKind
from gripper.verify.motion import clamp
from gripper.verify.report import Beam, Verification, VerifiedPose
from gripper.verify.run import Found, Model, run

Progress = Callable[[int, int], None]
Vector = tuple[float, float]


def verify(
    scene: Scene,
    parameters: Sequence[float] | None = None,
    *,
    elements: tuple[int, int] = (108, 12),
    law: LawName = "svk",
    jaw: JawKind = "rigid",
    friction: Friction | None = None,
    laws: bool = False,
    result: Result | None = None,
    progress: Progress | None = None,
) -> Verification:
    """Solve a scene with two-dimensional finite elements and compare.

    Quadratic elements (nine nodes), total Lagrangian, plane stress or strain as the material says; E and nu alone (a
    shear modulus of its own is the beam's). Contact of the real surface with the object's g.

    Parameters
    ----------
    scene
        What to solve.
    parameters
        Values of the motion's parameter to compare at, in the order in which the motion passes them; all its poses by
        default. The motion is followed from its start whatever is asked: a finger's shape depends on its way.
    elements
        Along the finger and across; the mesh error comes from a second mesh of half as many.
    law
        "svk" (St. Venant-Kirchhoff), "biot" (linear in the stretch, the beam's counterpart) or "hencky" (logarithmic).
    jaw
        "rigid" (moves with the end face), or "elastic": of the finger's material, with the finger going on above it.
    friction
        Coulomb's coefficient in place of the scene's: a number, or one for "finger" and one for "jaw". Slip, stick and
        memory are found along the motion, from its first touch on; without a motion the scene's sense is taken.
    laws
        Whether to say what the other laws alone would change (two more runs on the second mesh).
    result
        Gripper's own result of this scene with its poses; solved here where it is not given.
    progress
        Called after each pose of each run, with their number done and the total.

    Returns
    -------
    A report: ``str(report)``, ``report.to_dict()``, ``report.csv()``.

    Raises
    ------
    ValueError
        An argument against its rule, or a profile that is not positive.
    LookupError
        An unknown law or part.
    """
    _check(elements, jaw, friction)
    way, wanted = _way(scene.motion, parameters)
    models = _models(Model(elements=elements, law=law, jaw=jaw, friction=friction), laws)
    tick = _ticker(progress, len(models) * sum(wanted))
    if result is None:
        result = _solved(scene, way)
        poses = [pose for pose, asked in zip(result.poses, wanted, strict=True) if asked]
    else:
        poses = _picked(result, [value for value, asked in zip(way, wanted, strict=True) if asked])
    runs = {name: run(scene, model, way, wanted, tick) for name, model in models.items()}
    places = [value for value, asked in zip(way, wanted, strict=True) if asked]
    entries = [
        _pose(scene, value, pose, {name: found[i] for name, found in runs.items()})
        for i, (value, pose) in enumerate(zip(places, poses, strict=True))
    ]
    return Verification(scene=scene, model=models["fine"], second=models["coarse"].elements, poses=tuple(entries))


def _check(elements: tuple[int, int], jaw: str, friction: Friction | None) -> None:
    if min(elements) < 2 or any(int(n) != n for n in elements):
        raise ValueError(f"elements must be two whole numbers, at least 2; got {elements!r}")
    if jaw not in ("rigid", "elastic"):
        raise LookupError(f"unknown jaw {jaw!r}; known: rigid, elastic")
    if friction is not None:
        check(friction)


def _models(model: Model, laws: bool) -> dict[str, Model]:
    """The runs, by name: both meshes, and the other laws on the second."""
    n_along, n_across = model.elements
    coarse = replace(model, elements=(n_along // 2, max(1, n_across // 2)))
    others: dict[str, Model] = {name: replace(coarse, law=name) for name in LAWS if laws and name != model.law}
    return {"fine": model, "coarse": coarse, **others}


def _ticker(progress: Progress | None, total: int) -> Callable[[], None]:
    done = iter(range(1, total + 1))

    def tick() -> None:
        if progress is not None:
            progress(next(done), total)

    return tick


def _way(motion: Motion | None, parameters: Sequence[float] | None) -> tuple[list[float], list[bool]]:
    """Values to visit, and which of them are asked for: the start, every turn, and the poses."""
    if motion is None:
        if parameters is not None:
            raise ValueError(f"parameters must be left out for a scene without motion; got {parameters!r}")
        return [0.0], [True]
    if parameters is None:
        return list(motion.values), [True] * len(motion.values)
    asked = list(parameters)
    way = list(_passed(motion.values, asked))
    if asked or not way:
        raise ValueError(f"parameters must be values that the motion passes, in its order; got {asked!r} left over")
    return [value for value, _ in way], [wanted for _, wanted in way]


def _passed(values: Sequence[float], asked: list[float]) -> Iterator[tuple[float, bool]]:
    """The way along these values through those asked for, which are taken off the list."""
    start = values[0]
    at_start = bool(asked) and asked[0] == start
    yield (asked.pop(0) if at_start else start), at_start
    for before, after in pairwise(values):
        low, high = min(before, after), max(before, after)
        while asked and low <= asked[0] <= high and asked[0] != before:
            yield asked.pop(0), True
        if not asked:
            return
        if asked[0] != after:
            yield after, False


def _solved(scene: Scene, way: Sequence[float]) -> Result:
    from gripper.solve import solve  # here: the elements themselves need nothing of the solver
    from gripper.trace import trace

    if scene.motion is None:
        return solve(scene)
    return trace(replace(scene, motion=Motion(scene.motion.parameter, tuple(way))))


def _picked(result: Result, values: Sequence[float]) -> list[PoseResult]:
    """The poses of a result at these values, in order."""
    if result.scene.motion is None:
        return list(result.poses)
    poses = iter(result.poses)
    picked = [pose for value in values for pose in [next((p for p in poses if p.parameter == value), None)] if pose]
    if len(picked) != len(values):
        raise ValueError(f"result must hold the poses asked for, in their order; got {len(picked)} of {len(values)}")
    return picked


def _pose(scene: Scene, value: float, pose: PoseResult, runs: dict[str, Found]) -> VerifiedPose:
    fine, coarse = runs["fine"], runs["coarse"]
    beam = _beam(scene, value, pose)
    others: dict[str, float | None] = {
        name: _larger(coarse.force, found.force) for name, found in runs.items() if name in LAWS
    }
    return VerifiedPose(
        parameter=value if scene.motion else None,
        elements=fine,
        gripper=beam,
        force_difference=_apart(fine.force, beam.force),
        tip_difference=math.dist(fine.tip, beam.tip) if fine.tip and beam.tip else None,
        mesh_error=_apart(fine.force, coarse.force),
        laws=others,
    )


def _beam(scene: Scene, value: float, pose: PoseResult) -> Beam:
    """Gripper's pose in the clamp's frame."""
    tip = clamp(scene, value).local(np.array([pose.tip]))[0] if pose.tip else None
    return Beam(
        status=pose.status,
        force=pose.force_on_object_finger_frame,
        tip=None if tip is None else (float(tip[0]), float(tip[1])),
        contacts=pose.contacts,
        max_strain=pose.max_strain,
        seconds=pose.seconds,
    )


def _apart(force: Vector | None, other: Vector | None) -> float | None:
    """Distance of two forces, relative to the first; None where one is missing or the first is zero."""
    if force is None or other is None or math.hypot(*force) == 0:
        return None
    return math.dist(force, other) / math.hypot(*force)


def _larger(force: Vector | None, other: Vector | None) -> float | None:
    """How much larger the other force is, relative."""
    if force is None or other is None or math.hypot(*force) == 0:
        return None
    return math.hypot(*other) / math.hypot(*force) - 1
