"""From a verified equilibrium to plain numbers: forces, checks, the error estimate, the shape. SI, world frame."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.kinematics import Placement
from gripper.contact.linear import linearise
from gripper.result import ErrorEstimate, PoseResult, Shape
from gripper.results.kept import Kept
from gripper.statics.applied import applied
from gripper.statics.checked import checked, shortcoming
from gripper.statics.clearance import clearance
from gripper.statics.contact_forces import NO_FORCE, cross, drive, loads
from gripper.statics.enriched import relative_change
from gripper.statics.equilibrium import Equilibrium, Setting, State
from gripper.statics.profile import drawn, largest_strain, profile, unknown
from gripper.statics.reported import contacts, vector
from gripper.statics.verified import Verified


def discretisation_error(setting: Setting, equilibrium: Equilibrium) -> float:
    """Relative error of the force vector: one Newton step of the system enriched by two modes a field, contacts fixed.

    Of a finger that only its loads bend: of the tip's deflection.
    """
    state = equilibrium.state
    if not state.sites and equilibrium.linear.push is None:
        return 0.0
    if equilibrium.enriched is not None:
        return relative_change(equilibrium, *equilibrium.enriched)
    richer, _ = state.enriched()
    lin = linearise(richer.beam, richer.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
    return relative_change(equilibrium, richer, lin)


@dataclass(frozen=True, eq=False)
class Answer:
    """A pose's verified equilibrium with its error estimate."""

    verified: Verified
    error: float
    seconds: float
    iterations: int


def pose_result(
    setting: Setting, answer: Answer, parameter: float | None, placement: Placement, *, measured: bool = True
) -> PoseResult:
    """The plain numbers of a pose; failed where a check is not met.

    Where not ``measured``, the distance of a finger without contacts from its object (None) is left for
    :func:`gripper.statics.clearance.clearances`, which finds those of many poses together.
    """
    seen = profile(setting, answer.verified.equilibrium.state)
    checks = checked(setting, answer.verified)
    reason = (
        _penetrated(answer.verified) or shortcoming(checks) or unknown(setting, answer.verified.equilibrium.state, seen)
    )
    if reason:
        return PoseResult.failed(parameter, reason, answer.iterations, answer.seconds)
    scales, equilibrium = setting.sections, answer.verified.equilibrium
    state = equilibrium.state
    force = -equilibrium.force * scales.force_scale
    turn = placement.turn
    points, forces = loads(equilibrium)
    free = float(np.max(np.abs(forces), initial=0.0)) <= NO_FORCE
    moment = -cross(points - equilibrium.obstacle.frame.origin, forces)
    strain, strain_s = largest_strain(setting, equilibrium)
    return PoseResult(
        parameter=parameter,
        status="free" if free else "contact",
        force_on_object=vector(turn * force),
        force_on_object_finger_frame=vector(force),
        moment_on_object=moment * scales.energy_scale,
        motion_force=None if parameter is None else drive(equilibrium) * scales.energy_scale,
        clamp_moment=_clamp_moment(equilibrium) * scales.energy_scale,
        energy=state.energy * scales.energy_scale,
        load_energy=_load_energy(setting, equilibrium),
        tip=vector(placement.origin + turn * complex(seen.position[-1]) * scales.length),
        tip_rotation=float(seen.psi[-1]),
        max_strain=strain,
        max_strain_s=None if free and not strain else strain_s * scales.length,
        min_gap=clearance(setting, answer.verified) * scales.length if measured or state.sites else None,
        contacts=() if free else contacts(setting, equilibrium, placement),
        loads=applied(equilibrium, placement, scales),
        checks=checks,
        error=ErrorEstimate(discretisation=answer.error),
        iterations=answer.iterations,
        seconds=answer.seconds,
        shape=Shape.later(functools.partial(_shape, setting, state, placement), float(np.ptp(seen.psi))),
        kept=Kept(setting, equilibrium),
    )


def _penetrated(verified: Verified) -> str | None:
    return None if verified.survey.clear else "the object penetrates the finger"


def _clamp_moment(equilibrium: Equilibrium) -> float:
    """EI psi'(0): of the contact forces and the loads about the clamp."""
    moment, acting = cross(*loads(equilibrium)), equilibrium.obstacle.acting
    if acting is None:
        return moment
    return moment + float(acting.beyond(equilibrium.state.axis, np.zeros(1), np.zeros(1, dtype=np.intp))[1][0])


def _load_energy(setting: Setting, equilibrium: Equilibrium) -> float | None:
    """The loads' potential, in J, where all have one."""
    push = equilibrium.linear.push
    return push.potential * setting.sections.energy_scale if push is not None and push.conservative else None


def _shape(setting: Setting, state: State, placement: Placement) -> dict[str, Any]:
    """The fields of a pose's shape."""
    seen, length, jaw = drawn(setting, state), setting.sections.length, setting.outline.jaw
    position, half = seen.position, setting.sections.thickness(seen.s) / 2
    section = np.exp(1j * seen.psi)
    across = 1j * half * section

    def world(points: Complex) -> Array:
        placed = placement.origin + placement.turn * length * points
        return placed.view(float).reshape(-1, 2)

    return {
        "axis": world(position),
        "lower": world(position - across),
        "upper": world(position + across),
        "strain": np.abs(seen.kappa) * half,
        "jaw": None if jaw is None else world(position[-1] + jaw * section[-1]),
        "clamp_pose": placement.clamp,
        "object_pose": placement.object,
    }
