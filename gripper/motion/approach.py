"""An object comes from where the finger is free to its pose: straight there, or step by step where that is in doubt."""

from __future__ import annotations

from dataclasses import replace

from gripper.contact.kinematics import Retreat
from gripper.contact.obstacle import Frame
from gripper.motion.leap import leap, leaps, met
from gripper.motion.tracker import tracker_for
from gripper.statics.answer import Answer
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting
from gripper.statics.nearby import sampled_gap
from gripper.statics.newton import unloaded
from gripper.statics.sampling import DEPTH
from gripper.statics.verified import Verified, stability, untouched

HELD = "the object holds the finger"
"""How the reason of a pose begins to which no free pose leads."""
_WIDE = 0.5  # of L: deep in an object g does not tell how deep
_FURTHEST = 20.0  # of L: beyond this no retreat is tried


def approach(fixed: Setting, final: Frame, direction: tuple[float, float], order: int) -> tuple[Answer, int]:
    """The equilibrium that is reached when the object comes along a direction from where it is free.

    Parameters
    ----------
    fixed
        Finger, theory, object.
    final
        Where the object comes to.
    direction
        Of its coming, in the clamp's frame.
    order
        Order of the strain fields to start with.

    Returns
    -------
    The answer at the pose, and the order of the strain fields that it needed.

    Raises
    ------
    NoEquilibriumError
        Where no retreat frees the finger, or no equilibrium could be followed on the way back.
    """
    path = Retreat(final, complex(*direction) / abs(complex(*direction)))
    (free, start), sunk = retreated(fixed, path, order)
    tracker = tracker_for(fixed)(fixed, path, free, order, events=False, free=start)
    if sunk is not None and leaps(fixed):
        straight_there = leap(fixed, path, start, sunk)
        if straight_there is not None:
            return tracker.arrive(0.0, straight_there), tracker.order
    return tracker.advance(0.0), tracker.order


def first_pace(fixed: Setting) -> float:
    """How far (by L) to retreat at a time: a little less than the tracker's first step may be, so that one suffices."""
    return min(max(0.49 * fixed.body.inner_radius / fixed.sections.length, 0.01), 0.098)


def retreated(fixed: Setting, path: Retreat, order: int) -> tuple[tuple[float, Verified], float | None]:
    """The first free pose on the way back, and the last place before it that is not.

    This is None where the pose itself is free. Where the way can be leapt the two are no further apart than a pace. A
    sample of the outline in the object shows that a pose is not free; that one is free takes a survey.

    Raises
    ------
    NoEquilibriumError
        Where no retreat frees the finger.
    """
    pace, back, sunk = first_pace(fixed), 0.0, None
    bent = unloaded(fixed, fixed.obstacle(path.frame(0.0)), order)
    while True:
        gap = sampled_gap(fixed, fixed.obstacle(path.frame(-back)), bent.state)
        if gap >= -DEPTH:
            if sunk is not None and leaps(fixed):
                back, sunk = met(fixed, path, bent.state, (-back, gap), sunk, pace)
            free = replace(bent, obstacle=fixed.obstacle(path.frame(-back)))
            found = survey(fixed, free.obstacle, free.state, brief=True)
            start = Verified(free, found, stability(free))
            if untouched(fixed, start):
                return (-back, start), None if sunk is None else sunk[0]
            gap = found.min_gap
        if back > _FURTHEST:
            direction = f"({path.direction.real:.3g}, {path.direction.imag:.3g})"
            raise NoEquilibriumError(
                f"{HELD} however far it retreats against {direction}: "
                "give another direction in [approach], or a motion that starts from a free pose"
            )
        sunk = -back, gap
        back += max(pace, min(-gap, max(back, _WIDE)))
