"""One pose: approached from outside, solved, verified."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from gripper.assemble import first_order, left_out, setting
from gripper.contact.kinematics import Kinematics, Placement, Retreat
from gripper.contact.obstacle import Frame
from gripper.motion.approach import approach
from gripper.motion.locked import LockedError
from gripper.motion.tracker import tracker_for
from gripper.result import Model, PoseResult, Result
from gripper.results.extremes import Extreme
from gripper.scene import Scene
from gripper.statics.answer import Answer, pose_result
from gripper.statics.equilibrium import NoEquilibriumError, Setting, reckoned
from gripper.statics.ladder import rungs, suffices, theory_difference
from gripper.statics.validity import all_free, plane_difference, unknown_between, unmoved, warnings

NOT_MODELLED = (
    "deformation of the section and of the surface at the contact",
    "out-of-plane deformation",
    "plasticity",
    "inertia",
)
UNLOADING = "unloading on another curve (Mullins' effect, plastic set)"
AXIAL = "how the axial force stiffens sections of a nonlinear material (theory stretch has it)"
FLUTTER = "flutter: loads that follow the finger may shake it before they turn it over; statics do not tell"
PUBLISHED = "equilibrium with friction: the paper's approximation, its frictionless shape with forces split afterwards"


def model(scene: Scene, fixed: Setting, poses: Sequence[PoseResult], peak: Extreme | None = None) -> Model:
    """What is solved for this scene, what is not, and where these poses leave what the theory holds.

    Parameters
    ----------
    scene, fixed, poses
        What was solved.
    peak
        The largest strain along the motion, also between the poses.
    """
    own = (PUBLISHED,) if scene.friction and scene.friction.published else ()
    bent = () if fixed.sections.rest is None else ("curvature of the section at rest",)
    law: tuple[str, ...] = () if fixed.sections.law is None else (UNLOADING,)
    if law and fixed.theory != "stretch":
        law = (*law, AXIAL)
    follows: tuple[str, ...] = () if fixed.loads is None or fixed.loads.conservative else (FLUTTER,)
    notes = (plane_difference(fixed.sections.finger.material), *NOT_MODELLED, *law, *bent, *own, *follows)
    beyond = (
        *unmoved(scene, fixed.loads),
        *all_free(poses),
        *warnings(fixed.sections, poses, scene.tolerance),
        *unknown_between(fixed.sections, peak),
    )
    return Model(theory=fixed.theory, left_out=left_out(scene, fixed.theory), not_modelled=notes, warnings=beyond)


def numbers(
    scene: Scene,
    fixed: Setting,
    answer: Answer,
    parameter: float | None,
    placement: Placement,
    *,
    measured: bool = True,
) -> PoseResult:
    """The plain numbers of a pose, in the scene's model of friction.

    Where not ``measured``, the distance of a finger without contacts from its object is left to be found.
    """
    pose = pose_result(fixed, answer, parameter, placement, measured=measured)
    if scene.theory == "auto" and pose.status != "failed":
        change = theory_difference(fixed, answer.verified.equilibrium)
        pose = pose.but(error=pose.error.but(next_theory=change))
    if scene.friction is None or not scene.friction.published:
        return pose
    from gripper.contact.law import Law
    from gripper.statics.splitting import split

    return split(fixed, Law.of(scene.friction, fixed.outline, fixed.sections.length), answer, placement, pose)


def _approached(scene: Scene, fixed: Setting, frame: Frame) -> Answer:
    """The answer at a pose; friction of a given sense grows there, from none, because it may lock on the way."""
    order, direction = first_order(scene.tolerance), scene.approach
    if fixed.friction is None:
        return approach(fixed, frame, direction, order)[0]
    from gripper.motion.locking import grown

    try:
        smooth, reached = approach(replace(fixed, friction=None), frame, direction, order)
        equilibrium = smooth.verified.equilibrium
        state = grown(fixed, equilibrium, reached)
        if state is not None:
            start = replace(smooth.verified, equilibrium=replace(equilibrium, state=state))
            path = Retreat(frame, complex(*direction) / abs(complex(*direction)))
            return tracker_for(fixed).resume(fixed, path, 0.0, reached, start).advance(0.0)
    except NoEquilibriumError:
        return approach(fixed, frame, direction, order)[0]  # contacts change as friction grows: it grows on the way
    return approach(fixed, frame, direction, order)[0]


def solve(scene: Scene) -> Result:
    """Bent shape and contact forces at one pose, the object coming along ``scene.approach``.

    Parameters
    ----------
    scene
        Of one pose (without motion).

    Returns
    -------
    The pose's result; ``failed`` with a reason where no verified equilibrium is reached.

    Raises
    ------
    ValueError
        A scene with a motion (trace it), or a finger whose profile is not positive.
    """
    if scene.motion is not None:
        raise ValueError(
            f"scene must have no motion (gripper.trace follows one); got {scene.motion.parameter!r} with its values"
        )
    for theory in rungs(scene):
        fixed = setting(scene, theory)
        pose = _posed(scene, fixed)
        if suffices(scene, theory, pose):
            break
    poses = (pose,)
    return Result(title=scene.title, scene=scene, model=model(scene, fixed, poses), poses=poses, events=())


def _posed(scene: Scene, fixed: Setting) -> PoseResult:
    """The pose by one theory."""
    kinematics = Kinematics(scene, fixed.sections.length)
    frame = kinematics.frame(0.0)
    began = time.process_time()
    try:
        with reckoned():
            answer = _approached(scene, fixed, frame)
            pose = numbers(scene, fixed, answer, None, kinematics.placement(0.0))
    except LockedError as error:
        pose = PoseResult(parameter=None, status="locked", reason=str(error))
    except NoEquilibriumError as error:
        pose = PoseResult.failed(None, str(error))
    return pose.but(seconds=time.process_time() - began)
