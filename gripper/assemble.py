"""Scene to NCO problem, with only what the scene needs: the unknowns, terms and constraints of its pose."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gripper.beam.sections import sections
from gripper.beam.strains import BeamTheory
from gripper.contact.kinematics import Kinematics
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import LOWER, UPPER, Outline
from gripper.contact.site import Site
from gripper.pose import placed
from gripper.result import LeftOut
from gripper.scene import Scene
from gripper.statics.certificate import Survey, survey
from gripper.statics.compiled_loads import compiled_loads
from gripper.statics.equilibrium import Setting, State
from gripper.statics.nearby import near
from gripper.statics.problem import Problem

if TYPE_CHECKING:
    from gripper.contact.law import Law

_ARCS = np.concatenate([[0.0], np.geomspace(0.02, 3.0, 24)])
_ORDERS = ((1e-2, 2), (1e-3, 3), (1e-4, 4), (1e-6, 5), (1e-8, 7), (0.0, 9))


def setting(scene: Scene, theory: BeamTheory | None = None) -> Setting:
    """What stays the same over all poses of a scene: compiled once a finger and once an object.

    Parameters
    ----------
    scene
        What is given.
    theory
        In place of the scene's; "auto" is shear where nobody chooses.
    """
    finger = placed(scene.finger).body
    profile = sections(finger)
    chosen = theory or ("shear" if scene.theory == "auto" else scene.theory)
    outline = Outline(profile)
    friction = _law(scene, outline, profile.length)
    loads = compiled_loads(scene, profile) if scene.loads else None
    return Setting(profile, outline, chosen, placed(scene.object).body, scene.tolerance, friction, loads)


def _law(scene: Scene, outline: Outline, length: float) -> Law | None:
    """Friction in equilibrium, where there is any: mu = 0 leaves all of it out."""
    friction = scene.friction
    if friction is None or friction.absent or friction.published:
        return None
    from gripper.contact.law import Law

    return Law.of(friction, outline, length)


def first_order(tolerance: float) -> int:
    """The order of the strain fields to start from; the error estimate decides whether it stays."""
    return next(order for limit, order in _ORDERS if tolerance >= limit)


def left_out(scene: Scene, theory: BeamTheory) -> tuple[LeftOut, ...]:
    """What this scene does not need, and why."""
    finger = placed(scene.finger).body
    out = []
    if scene.friction is None or scene.friction.absent:
        out.append(LeftOut(what="friction", why="coefficient is 0" if scene.friction else "none is given"))
    why = (
        f"it changes forces by less than {100 * scene.theory_tolerance:.2g} %" if scene.theory == "auto" else "as asked"
    )
    missing = {"bending": ("shear strain", "stretch of the axis"), "shear": ("stretch of the axis",), "stretch": ()}
    out += [LeftOut(what=what, why=f"theory is {theory}: {why}") for what in missing[theory]]
    if finger.jaw is None:
        out.append(LeftOut(what="jaw", why="the finger has none"))
    return tuple(out)


def assemble(scene: Scene, parameter: float | None = None) -> Problem:
    """The NCO problem of a scene at one pose, ready for SciPy.

    It starts from the least circular arc that clears the object on the side that the object comes from.

    Parameters
    ----------
    scene
        What is given.
    parameter
        Value of the motion's parameter; its first value by default. None in a scene without motion.

    Raises
    ------
    ValueError
        A parameter in a scene without motion, or a pose that is not finite there.
    """
    if parameter is not None and scene.motion is None:
        raise ValueError(f"parameter must be None in a scene without motion; got {parameter!r}")
    fixed = setting(scene)
    at = parameter if parameter is not None else (scene.motion.values[0] if scene.motion else 0.0)
    obstacle = fixed.obstacle(Kinematics(scene, fixed.sections.length).frame(at))
    order = first_order(scene.tolerance)
    bend = 1.0 if scene.approach[1] >= 0 else -1.0
    start, found = _clear_arc(fixed, obstacle, order, bend)
    touching = found.pieces.piece <= UPPER
    least = np.where(touching, found.gaps.min(axis=0), np.inf)
    place = float((found.pieces.u0 + found.pieces.u1)[np.argmin(least)] / 2)
    start = start.on(fixed.beam((Site("tangent", LOWER, (place,)),), order))
    found = survey(fixed, obstacle, start)
    problem = Problem(fixed, obstacle, start, near(fixed, obstacle, start, found, reach=0.1))
    problem.left_out = left_out(scene, fixed.theory)
    return problem


def _clear_arc(fixed: Setting, obstacle: Obstacle, order: int, bend: float) -> tuple[State, Survey]:
    """The least arc that clears the object (the straight finger where none does)."""
    beam = fixed.beam((), order)
    straight = State(beam, np.zeros(beam.size))
    for curvature in _ARCS:
        strains = np.zeros((beam.fields, beam.gauss.size))
        strains[0] = bend * curvature
        state = replace(straight, z=beam.fit(strains))
        found = survey(fixed, obstacle, state)
        if found.min_gap >= 0 and not found.engulfed:
            return state, found
    return straight, survey(fixed, obstacle, straight)
