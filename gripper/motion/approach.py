"""An object comes from where the finger is free to its pose: straight there, or step by step where that is in doubt."""

from __future__ import annotations

from gripper.contact.kinematics import Retreat
from gripper.contact.obstacle import Frame
from gripper.motion.leap import leap
from gripper.motion.tracker import tracker_for
from gripper.statics.answer import Answer
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting
from gripper.statics.newton import unloaded
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
    pace = first_pace(fixed)
    (free, start), sunk = retreated(fixed, path, order)
    tracker = tracker_for(fixed)(fixed, path, free, order, events=False, free=start)
    if sunk is not None and -free > pace:  # one step of the tracker's would not do
        straight_there = leap(fixed, path, (free, start), sunk, pace)
        if straight_there is not None:
            return tracker.arrive(0.0, straight_there), tracker.order
    return tracker.advance(0.0), tracker.order


def first_pace(fixed: Setting) -> float:
    """How far (by L) to retreat at a time: a little less than the tracker's first step may be, so that one suffices."""
    return min(max(0.49 * fixed.body.inner_radius / fixed.sections.length, 0.01), 0.098)


def retreated(
    fixed: Setting, path: Retreat, order: int
) -> tuple[tuple[float, Verified], tuple[float, Verified] | None]:
    """The first free pose on the way back, and the last one before it that is not: None where the pose itself is free.

    Raises
    ------
    NoEquilibriumError
        Where no retreat frees the finger.
    """
    back, sunk = 0.0, None
    while True:
        free = unloaded(fixed, fixed.obstacle(path.frame(-back)), order)
        found = survey(fixed, free.obstacle, free.state, brief=True)
        start = Verified(free, found, stability(free))
        if untouched(fixed, start):
            return (-back, start), sunk
        if back > _FURTHEST:
            direction = f"({path.direction.real:.3g}, {path.direction.imag:.3g})"
            raise NoEquilibriumError(
                f"{HELD} however far it retreats against {direction}: "
                "give another direction in [approach], or a motion that starts from a free pose"
            )
        sunk = -back, start
        back += max(first_pace(fixed), min(-found.min_gap, max(back, _WIDE)))
