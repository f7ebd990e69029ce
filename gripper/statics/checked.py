"""What is verified of an equilibrium: stationarity, balance, stability, penetration."""

from __future__ import annotations

import numpy as np

from gripper.contact.outline import dot
from gripper.result import Checks
from gripper.statics.contact_forces import NO_FORCE, loads
from gripper.statics.equilibrium import Equilibrium, Setting
from gripper.statics.profile import balanced, carried
from gripper.statics.verified import Verified, one_sided

STATIONARY = 1e-8
BALANCED = 1e-2


def checked(setting: Setting, verified: Verified) -> Checks:
    """Stationarity, balance of forces and moments, stability, penetration (PHYSICS: what a right answer satisfies).

    The balance compares the moments that the strains carry with those of the contact forces (Lan & Lee eq 6, for any
    number of contacts) and of the loads.
    """
    equilibrium, survey = verified.equilibrium, verified.survey
    state, lin = equilibrium.state, equilibrium.linear
    stationarity = force = moment = 0.0
    if state.sites or lin.push is not None:
        load = lin.load(state.multipliers)
        total = max(float(np.abs(loads(equilibrium)[1]).sum()) + _acting(equilibrium), NO_FORCE)
        stationarity = float(np.linalg.norm(state.energy_gradient - load)) / max(float(np.linalg.norm(load)), NO_FORCE)
        force, moment = (missing / total for missing in _imbalance(setting, equilibrium))
    return Checks(
        stationarity=stationarity,
        force_balance=force,
        moment_balance=moment,
        stability=None if one_sided(equilibrium) else verified.stability,
        singularity=verified.stability if one_sided(equilibrium) else None,
        penetration_bound=survey.penetration_bound * setting.sections.length,
        certificate="proved" if survey.proved else "sampled",
    )


def _acting(equilibrium: Equilibrium) -> float:
    """The size of what else loads the finger, forces and couples."""
    acting = equilibrium.obstacle.acting
    if acting is None:
        return 0.0
    felt = acting.felt(equilibrium.state.axis)
    return float(np.abs(felt.forces).sum() + np.abs(felt.couples).sum())


def _imbalance(setting: Setting, equilibrium: Equilibrium) -> tuple[float, float]:
    """Force and moment at the clamp that the strains carry beyond the contact forces' and the loads'.

    The moment (EI kappa) between the clamp and the first contact, less all that acts further out about the sections, is
    fitted by a couple and a force across the chord (a nearly straight finger tells nothing of one along it). It is
    read at the zeros of P_(p+1), where the error of a projection on polynomials of order p is of higher order.
    """
    points, forces = loads(equilibrium)
    seen = balanced(setting, equilibrium.state)
    position = seen.position
    applied = ((points[None, :] - position[:, None]).conj() @ forces[:, None]).imag[:, 0]
    acting = equilibrium.obstacle.acting
    if acting is not None:
        applied = applied + acting.beyond(equilibrium.state.axis, seen.s, seen.segment)[1]
    missing = carried(setting, equilibrium.state, seen) - applied
    arms = -dot(position, position[-1] / abs(position[-1]))
    middle = arms - arms.mean()
    across = float(middle @ missing / (middle @ middle)) if len(arms) > 1 else 0.0
    couple = float(missing.mean() - across * arms.mean())
    return abs(across), abs(couple)


def shortcoming(checks: Checks) -> str | None:
    """Which check fails, in words, or None."""
    if (checks.stationarity or 0.0) > STATIONARY:
        return f"not stationary: {checks.stationarity:.1e} of the contact force is unbalanced"
    worst = max(checks.force_balance or 0.0, checks.moment_balance or 0.0)
    if worst > BALANCED:
        return f"forces and moments do not balance: {worst:.1e} of the contact force is missing"
    return None
