"""Which hold a new contact gets, and where on a step a contact changes its hold."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from gripper.motion.branch import SHARP, STILL, Along, Branch, Path, speed
from gripper.motion.locking import check_locked
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting
from gripper.statics.gathered import gathered
from gripper.statics.holds import (
    coefficient,
    grip_of,
    leaders,
    margin,
    overdue,
    ratio_rate,
    regripped,
    slip_rates,
    tangent,
)
from gripper.statics.verified import Verified, verify

_MOST = 8  # contacts that are decided one after the other
_AT_ONCE = 1e-9  # of its value at the step's end: a margin this small is none


def decided(setting: Setting, found: Verified, heading: float, order: int, *, soon: bool = True) -> Verified:
    """Contacts that came without a hold get the one that is consistent.

    Parameters
    ----------
    setting, heading, order
        Of the motion.
    found
        With the contacts that came.
    soon
        Whether that is soon behind where they came: else none sticks, as it is held where it is found.

    Raises
    ------
    NoEquilibriumError
        Where there is none.
    LockedError
        Where friction holds the finger.
    """
    for _ in range(_MOST):
        equilibrium = found.equilibrium
        undecided = [i for i in leaders(equilibrium) if grip_of(equilibrium, i).hold == "open"]
        if not undecided:
            return found
        found = verify(setting, _first_hold(setting, equilibrium, undecided[0], heading, order, soon=soon))
    raise NoEquilibriumError("the holds of the contacts contradict each other")


def _first_hold(
    setting: Setting, equilibrium: Equilibrium, i: int, heading: float, order: int, *, soon: bool
) -> Equilibrium:
    """Slip, if it goes on in its sense, the likelier sense first; else stick, if its ratio stays within mu."""
    if speed(equilibrium) < STILL:
        return regripped(setting, equilibrium, i, 0, order)
    likely = 1 if slip_rates(equilibrium)[i] * heading >= 0 else -1
    for sense in (likely, -likely):
        slipping = _slipping(setting, equilibrium, i, sense, heading, order)
        if slipping is not None:
            return slipping
    if not soon:
        raise NoEquilibriumError("a new contact does not slip")
    sticking = _sticking(setting, equilibrium, i, heading, order)
    if sticking is not None:
        return sticking
    check_locked(setting, equilibrium, heading)
    raise NoEquilibriumError("no hold of a new contact is consistent with Coulomb's law")


def _slipping(
    setting: Setting, equilibrium: Equilibrium, i: int, sense: int, heading: float, order: int
) -> Equilibrium | None:
    """Slip with a sense, if it goes on that way; friction may bring other contacts, and let some go."""
    try:
        found = regripped(setting, equilibrium, i, sense, order)
        try:
            found = verify(setting, found).equilibrium
        except NoEquilibriumError:
            found = gathered(setting, equilibrium.obstacle, found.state, found.state, order).equilibrium
            return found if not overdue(found, heading) else None
        return found if slip_rates(found)[i] * heading * sense > 0 else None
    except NoEquilibriumError:
        return None


def _sticking(setting: Setting, equilibrium: Equilibrium, i: int, heading: float, order: int) -> Equilibrium | None:
    """Stick from the first touch on: the ratio that it tends to."""
    try:
        found = regripped(setting, equilibrium, i, 0, order)
        first = grip_of(found, i).law.leader(found.state.sites, i)
        if first != i:  # it has the ratio of those that stick already
            return found if first not in overdue(found, heading) else None
        row = sum(site.multipliers for site in found.state.sites[:i])
        rate = float(tangent(found)[1][row]) / float(found.state.multipliers[row])
        return found if abs(ratio_rate(found, i)) <= coefficient(found, i) * abs(rate) else None
    except NoEquilibriumError:
        return None


def excess(equilibrium: Equilibrium, i: int) -> float:
    """On which side a contact that sticks leaves mu."""
    return float(np.sign(grip_of(equilibrium, i).ratio))


def changing(
    setting: Setting, path: Path, old: Along, new: Along, late: list[int], heading: float, order: int
) -> tuple[float, int, Branch]:
    """Where on a step the first contact changes its hold, which one that is, and the branch that leads there.

    Parameters
    ----------
    setting, path
        Of the motion.
    old, new
        Ends of the step, with the same contacts.
    late
        Those whose hold contradicts their motion or their force at its end.
    heading
        Sign of the way along the parameter.
    order
        Of the strain fields.

    Raises
    ------
    NoEquilibriumError
        Where the branch does not lead there.
    """
    kinds = [[site.kind for site in at.equilibrium.state.sites] for at in (old, new)]
    branch = Branch(setting, path, old if kinds[0] == kinds[1] else new, order)
    if kinds[0] == kinds[1]:
        branch.known.append(new)
    places = [_place(branch, old, new, i, heading) for i in late]
    first = min(range(len(late)), key=lambda k: abs(places[k] - old.parameter))
    return places[first], late[first], branch


def _place(branch: Branch, old: Along, new: Along, i: int, heading: float) -> float:
    """Where on the step a contact changes its hold."""
    bound = excess(new.equilibrium, i)

    def left(parameter: float) -> float:
        return margin(branch.at(parameter), i, heading, bound)

    if left(old.parameter) <= _AT_ONCE * abs(left(new.parameter)):
        return old.parameter
    sharp = SHARP * abs(new.parameter - old.parameter)
    return float(brentq(left, old.parameter, new.parameter, xtol=sharp, rtol=1e-14))
