"""The published friction: the frictionless shape, its force split afterwards (Lan & Lee, section 2.4, eqs 6 to 10).

With (9) corrected to Fnx Ftx + Fny Fty = 0, the force on the finger is N (1 - i rho) n, rho being mu with the sign
given, and N follows from the moment at the clamp (6), EI psi'(0) = P x F, of the frictionless shape. It holds for one
contact, and is an approximation: the shape is not in equilibrium with these forces.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from gripper.arrays import Complex
from gripper.contact.kinematics import Placement
from gripper.contact.law import Law
from gripper.result import Checks, PoseResult
from gripper.statics.answer import Answer
from gripper.statics.contact_forces import cross
from gripper.statics.equilibrium import Equilibrium, Setting


def split(setting: Setting, law: Law, answer: Answer, placement: Placement, pose: PoseResult) -> PoseResult:
    """A frictionless pose with its force split; failed where it has more than one contact.

    Parameters
    ----------
    setting
        Finger and object, without friction.
    law
        Gives mu and the sense.
    answer, placement, pose
        The frictionless answer, its place in the world and its numbers.
    """
    if pose.status != "contact":
        return pose
    if len(pose.contacts) != 1:
        reason = f"the published friction model takes one contact; here are {len(pose.contacts)}"
        return PoseResult.failed(pose.parameter, reason, pose.iterations, pose.seconds)
    found = split_forces(law, answer.verified.equilibrium)
    if found is None:
        reason = "the published friction model gives no force: the moment of friction exceeds the normal force's"
        return PoseResult.failed(pose.parameter, reason, pose.iterations, pose.seconds)
    return _with(setting, law, answer, placement, pose, *found)


def split_forces(law: Law, equilibrium: Equilibrium) -> tuple[Complex, float] | None:
    """Forces of the first contact on the finger (k,), over EI(0) / L^2, and their ratio; None where there are none."""
    site, lin = equilibrium.state.sites[0], equilibrium.linear
    ratio = -law.tipward * law.side(site) * law.at(site.piece, site.middle)[0]
    points, normals = np.concatenate(lin.points), np.concatenate(lin.forces)
    forces = normals * (1 - 1j * ratio)
    moment = cross(points, forces)
    if moment * cross(points, normals) <= 0:
        return None
    return forces * (cross(points, normals) / moment), ratio


def _with(
    setting: Setting, law: Law, answer: Answer, placement: Placement, pose: PoseResult, forces: Complex, ratio: float
) -> PoseResult:
    """The pose with other contact forces on the finger (k,)."""
    scales, equilibrium = setting.sections, answer.verified.equilibrium
    points = np.concatenate(equilibrium.linear.points)
    force = -complex(forces.sum()) * scales.force_scale
    world = placement.turn * force
    velocities = equilibrium.obstacle.velocities(points)
    power = float(np.sum((forces.conj() * velocities).real)) * scales.energy_scale
    normal_force = abs(force) / abs(1 - 1j * ratio)
    side = law.side(equilibrium.state.sites[0])
    contact = dataclasses.replace(
        pose.contacts[0], normal_force=normal_force, tangential_force=-ratio * normal_force * side, state="slip"
    )
    about = points - equilibrium.obstacle.frame.origin
    return dataclasses.replace(
        pose,
        force_on_object=(world.real, world.imag),
        force_on_object_finger_frame=(force.real, force.imag),
        moment_on_object=-cross(about, forces) * scales.energy_scale,
        motion_force=None if pose.parameter is None else power,
        contacts=(contact,),
        checks=Checks(
            moment_balance=pose.checks.moment_balance,
            penetration_bound=pose.checks.penetration_bound,
            certificate=pose.checks.certificate,
        ),
    )
