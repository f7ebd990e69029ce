"""Where a result has no derivative, or two."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gripper.contact.outline import Outline
from gripper.contact.site import Site
from gripper.fingers import Finger, Material
from gripper.names import shortened
from gripper.pose import placed
from gripper.results.kept import Kept
from gripper.results.pose_result import PoseResult
from gripper.scene import Scene
from gripper.statics.equilibrium import Equilibrium
from gripper.statics.holds import coefficient, grip_of, leaders, slip_rates, tangent

if TYPE_CHECKING:
    from gripper.result import Result

Side = Literal["exact", "one-sided", "none"]
_HERE = 1e-7  # of the motion's range: an event this near is at the pose
_END = 1e-7  # of L: a contact this near to the end of its piece is there
FEEBLE = 1e-7  # of the largest multiplier, of mu, of the largest slip
_SOFT = 1e-6  # smallest eigenvalue of the reduced Hessian: below it a snap
_KNOWN: dict[type, set[str]] = {
    Scene: {
        "finger",
        "object",
        "motion",
        "approach",
        "friction",
        "theory",
        "tolerance",
        "title",
        "limits",
        "tolerances",
        "theory_tolerance",
        "loads",
    },
    Finger: {"length", "width", "material", "jaw", "rest_curvature", "base"},
    Material: {
        *("youngs_modulus", "poisson_ratio", "shear_modulus", "plane"),
        *("yield_strain", "repeated_strain"),
        *("law", "table"),
    },
}
"""Fields whose part in the equations is differentiated, or that have none; a limit may stand in a scene."""


def refusal(scene: Scene) -> None:
    """Refuse a scene whose equations are not all differentiated.

    Raises
    ------
    ValueError
        Published friction, or a part of the model that has no derivatives here.
    """
    friction = scene.friction
    if friction is not None and friction.published:
        raise ValueError("model of friction must be 'coulomb', to be differentiated; got 'published'")
    finger = placed(scene.finger).body
    parts: list[tuple[type, Any]] = [(Scene, scene), (Finger, finger), (Material, finger.material)]
    for cls, part in parts:
        for field in dataclasses.fields(cls):
            if field.name not in _KNOWN[cls] and getattr(part, field.name) != _default(field):
                got = shortened(repr(getattr(part, field.name)))
                raise ValueError(f"{field.name} must be left out, to be differentiated; got {got}")


def _default(field: dataclasses.Field[Any]) -> Any:
    return field.default_factory() if field.default_factory is not dataclasses.MISSING else field.default


def side(result: Result, pose: PoseResult, kept: Kept) -> tuple[Side, str | None]:
    """Whether a pose's derivatives are exact, one-sided or none, and why."""
    for event in _events(result, pose):
        if event.kind == "snap":
            return "none", f"the finger snaps at {event.parameter:.6g}: {event.detail}"
        return "one-sided", f"{event.kind} at this pose: {event.detail}"
    checks = pose.checks
    firmness = checks.stability if checks.singularity is None else checks.singularity
    if firmness is not None and firmness < _SOFT:
        return "none", f"the equilibrium is about to snap (stability {firmness:.1e})"
    grazing = not kept.equilibrium.state.sites and (pose.min_gap or 0.0) < _END * kept.setting.sections.length
    reason = "the object only just touches the finger" if grazing else edge(kept)
    return ("one-sided", reason) if reason else ("exact", None)


def _events(result: Result, pose: PoseResult) -> list[Any]:
    motion = result.scene.motion
    if motion is None or pose.parameter is None:
        return []
    near = _HERE * (max(motion.values) - min(motion.values))
    return sorted(
        (event for event in result.events if abs(event.parameter - pose.parameter) <= near),
        key=lambda event: event.kind != "snap",
    )


def edge(kept: Kept) -> str | None:
    """What is about to change at an equilibrium: a contact that lets go or leaves its piece, or a hold."""
    equilibrium, outline = kept.equilibrium, kept.setting.outline
    state, first = equilibrium.state, 0
    largest = float(np.max(np.abs(state.multipliers), initial=0.0))
    for site in state.sites:
        if state.multipliers[first] <= FEEBLE * largest and len(state.sites) > 1:
            return "a contact only grazes"
        if at_end(site, outline):
            return "a contact is at the end of its face or edge"
        first += site.multipliers
    return _holding(equilibrium)


def at_end(site: Site, outline: Outline) -> bool:
    """Whether a contact that has a place of its own is at the end of its piece."""
    if not site.unknown_places:
        return False
    ahead = outline.pieces[site.piece].length - site.place[site.unknown_places - 1]
    return site.place[0] < _END or ahead < _END


def _holding(equilibrium: Equilibrium) -> str | None:
    """Whether a contact is about to change its hold."""
    deciding = leaders(equilibrium)
    if not deciding or any(grip_of(equilibrium, i).law.tipward for i in deciding):
        return None
    rates = slip_rates(equilibrium)
    pace = float(np.linalg.norm(tangent(equilibrium)[0])) + 1.0
    for i in deciding:
        grip = grip_of(equilibrium, i)
        if grip.hold == "slip" and abs(rates[i]) < FEEBLE * pace:
            return "a contact is about to stick"
        mu = coefficient(equilibrium, i)
        if grip.hold == "stick" and mu - abs(grip.ratio) < FEEBLE * mu:
            return "a contact is about to slip"
    return None
