"""The second opinion: elements on two meshes, beside gripper's own result."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import get_args

import numpy as np

from gripper.fingers import Finger, Material
from gripper.pose import placed
from gripper.result import PoseResult, Result
from gripper.scene import Motion, Scene
from gripper.verify.material import LAWS, LawName
from gripper.verify.mesh import JawKind
from gripper.verify.motion import clamp, passing
from gripper.verify.report import Beam, OtherLaw, Verification, VerifiedPose
from gripper.verify.run import Found, Model, run

_KNOWN = {
    *("finger", "object", "motion", "approach", "friction", "theory", "title"),
    *("tolerance", "theory_tolerance", "limits", "tolerances"),
    *("length", "width", "material", "jaw"),
    *("youngs_modulus", "poisson_ratio", "shear_modulus", "plane", "yield_strain", "repeated_strain", "law"),
}
"""What a scene, its finger and its material say that the elements take in, or that changes no pose."""
_LAWS: dict[str, LawName] = {
    "linear": "svk",
    "st_venant_kirchhoff": "svk",
    "logarithmic": "hencky",
    "neo_hookean": "neo_hookean",
}
"""A material's law and the elements'."""
Progress = Callable[[int, int], None]
Vector = tuple[float, float]


def verify(
    scene: Scene,
    poses: Sequence[float] | None = None,
    *,
    elements: tuple[int, int] = (108, 4),
    law: LawName | None = None,
    jaw: JawKind = "rigid",
    laws: bool = True,
    result: Result | None = None,
    progress: Progress | None = None,
) -> Verification:
    """Solve a scene with two-dimensional finite elements and compare.

    Quadratic elements (nine nodes), total Lagrangian, plane stress or strain as the material says; E and nu alone (a
    shear modulus of its own is the beam's). Contact of the real surface with the object's g. With Coulomb friction
    slip, stick and memory are found along the motion, from its first touch on; without a motion the scene's sense is
    taken.

    Parameters
    ----------
    scene
        What to solve.
    poses
        Values of the motion's parameter to compare at, in the order in which the motion passes them (any order where
        it goes one way); all its poses by default. The motion is followed from its start whatever is asked: a finger's
        shape depends on its way.
    elements
        Along the finger and across; the mesh error comes from a second mesh of half as many. Few across are enough:
        what counts is that they are short where the finger touches.
    law
        "svk" (St. Venant-Kirchhoff), "biot" (linear in the stretch, the beam's counterpart), "hencky" (logarithmic) or
        "neo_hookean"; the material's own by default, "svk" where that is linear.
    jaw
        "rigid" (moves with the end face), or "elastic": of the finger's material, with the finger going on above it.
    laws
        Whether to say what "svk", "biot" and "hencky" alone would change (two or three more runs).
    result
        Gripper's own result of this scene with its poses; solved here where it is not given.
    progress
        Called after each pose of each run, with their number done and the total.

    Returns
    -------
    A report: ``str(report)``, ``report.to_dict()``, ``report.csv()``, ``report.markdown()``.

    Raises
    ------
    ValueError
        An argument against its rule, a profile that is not positive, or a scene with something that the elements do
        not know.
    LookupError
        An unknown law or kind of jaw.
    """
    law = law or _own(placed(scene.finger).body.material)
    _check(elements, law, jaw)
    _check_known(scene)
    way, wanted = passing(scene.motion, poses)
    places = [value for value, asked in zip(way, wanted, strict=True) if asked]
    models = _models(Model(elements=elements, law=law, jaw=jaw), laws)
    tick = _ticker(progress, len(models) * len(places))
    beams = _picked(result or _solved(scene, way), places)
    runs = {name: run(scene, model, way, wanted, tick) for name, model in models.items()}
    entries = [
        _pose(scene, value, beam, {name: found[i] for name, found in runs.items()})
        for i, (value, beam) in enumerate(zip(places, beams, strict=True))
    ]
    return Verification(
        scene=scene,
        model=models["fine"],
        second=models["coarse"].elements,
        poses=tuple(entries),
        more_seconds=sum(pose.seconds for name in models if name != "fine" for pose in runs[name]),
    )


def _own(material: Material) -> LawName:
    """The elements' law for a material.

    Raises
    ------
    ValueError
        A law that elements do not have.
    """
    if material.law not in _LAWS:
        raise ValueError(f"law must be one of {', '.join(_LAWS)}, to be verified; got {material.law!r}")
    return _LAWS[material.law]


def _check(elements: tuple[int, int], law: str, jaw: str) -> None:
    if len(elements) != 2 or min(elements) < 2 or any(int(n) != n for n in elements):
        raise ValueError(f"elements must be two whole numbers, at least 2; got {elements!r}")
    for what, name, known in (("law", law, get_args(LawName)), ("jaw", jaw, get_args(JawKind))):
        if name not in known:
            raise LookupError(f"unknown {what} {name!r}; known: {', '.join(known)}")


def _check_known(scene: Scene) -> None:
    """Refuse a scene that says something which the elements would leave out."""
    finger = placed(scene.finger).body
    parts = ("", scene, type(scene)), ("finger.", finger, Finger), ("material.", finger.material, type(finger.material))
    for name, given, kind in parts:
        for field in fields(kind):
            value = getattr(given, field.name)
            if field.name not in _KNOWN and value != field.default:
                rule = "must be left out to be verified, as the elements do not know it"
                raise ValueError(f"{name}{field.name} {rule}; got {value!r}")


def _models(model: Model, laws: bool) -> dict[str, Model]:
    """The runs, by name: both meshes, and the other laws."""
    n_along, n_across = model.elements
    coarse = replace(model, elements=(n_along // 2, n_across // 2))
    names: list[LawName] = [name for name in get_args(LawName) if laws and name in LAWS and name != model.law]
    others: dict[str, Model] = {name: replace(model, law=name) for name in names}
    return {"fine": model, "coarse": coarse, **others}


def _ticker(progress: Progress | None, total: int) -> Callable[[], None]:
    done = iter(range(1, total + 1))

    def tick() -> None:
        if progress is not None:
            progress(next(done), total)

    return tick


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
    return VerifiedPose(
        parameter=value if scene.motion else None,
        elements=fine,
        gripper=beam,
        force_difference=_apart(fine.force, beam.force),
        tip_difference=math.dist(fine.tip, beam.tip) if fine.tip and beam.tip else None,
        mesh_error=_apart(fine.force, coarse.force),
        laws={name: _other_law(fine.force, found.force, beam.force) for name, found in runs.items() if name in LAWS},
    )


def _other_law(own: Vector | None, other: Vector | None, beam: Vector | None) -> OtherLaw:
    """What another law changes in the force, and how far gripper's is from it."""
    change = None
    if own is not None and other is not None and math.hypot(*own) > 0:
        change = math.hypot(*other) / math.hypot(*own) - 1
    return OtherLaw(change=change, force_difference=_apart(other, beam))


def _beam(scene: Scene, value: float, pose: PoseResult) -> Beam:
    """Gripper's pose in the clamp's frame."""
    tip = clamp(scene, value).local(np.array([pose.tip]))[0] if pose.tip else None
    return Beam(
        status=pose.status,
        reason=pose.reason,
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
