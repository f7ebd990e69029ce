"""The ladder of beam theories: what the next richer one would change, and when a cheaper one is enough.

One Newton step of the next theory from the solved pose, contacts fixed: to first order, what solving it would change.
"""

from __future__ import annotations

from dataclasses import replace
from typing import get_args

from gripper.beam.strains import Beam, BeamTheory
from gripper.contact.linear import linearise
from gripper.result import PoseResult
from gripper.scene import Scene
from gripper.statics.contact_forces import NO_FORCE
from gripper.statics.enriched import relative_change
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting

RUNGS: tuple[BeamTheory, ...] = get_args(BeamTheory)
"""Theories from the cheapest to the richest."""


def richer(theory: BeamTheory) -> BeamTheory | None:
    """The next theory; None above the last."""
    above = RUNGS[RUNGS.index(theory) + 1 :]
    return above[0] if above else None


def rungs(scene: Scene) -> tuple[BeamTheory, ...]:
    """The theories that a scene is tried with, one after the other: all of them where it leaves the choice."""
    return RUNGS if scene.theory == "auto" else (scene.theory,)


def suffices(scene: Scene, theory: BeamTheory, pose: PoseResult) -> bool:
    """Whether a pose leaves the theory as the scene's choice: it is answered, and the next would change little."""
    if scene.theory != "auto" or theory == RUNGS[-1]:
        return True
    change = pose.error.next_theory
    return pose.status != "failed" and (change is None or change <= scene.theory_tolerance)


def theory_difference(setting: Setting, equilibrium: Equilibrium) -> float | None:
    """Relative change of the force vector with the next theory, to first order; None where there is no next one.

    Of a finger that only its loads bend: of the tip's deflection.

    Accurate to the square of the difference, and to what a patch of contact changes (2e-4).
    """
    above, state = richer(setting.theory), equilibrium.state
    if above is None:
        return None
    unloaded = equilibrium.linear.push is None
    if unloaded and (not state.sites or abs(equilibrium.force) <= NO_FORCE):
        return 0.0
    richly = Beam(setting.sections, state.beam.breaks, state.beam.order, above)
    there = replace(state, beam=richly, z=richly.embed(state.beam, state.z))
    lin = linearise(richly, there.z, setting.outline, equilibrium.obstacle, state.sites, state.multipliers)
    try:
        return relative_change(equilibrium, there, lin)
    except NoEquilibriumError:
        return None
