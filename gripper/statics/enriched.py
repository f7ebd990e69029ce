"""What a richer model would change of an equilibrium: one Newton step from it, the contacts' kinds kept."""

from __future__ import annotations

import numpy as np

from gripper.arrays import Array
from gripper.beam.axis import Axis
from gripper.contact.linearisation import Linearisation
from gripper.statics.contact_forces import NO_FORCE
from gripper.statics.equilibrium import Equilibrium, State, kkt_step


def relative_change(equilibrium: Equilibrium, richer: State, lin: Linearisation) -> float:
    """Change of the force on the object, relative to it, or to what else loads the finger where that is larger.

    Of a finger that only its loads bend: the tip's, relative to its deflection.

    Parameters
    ----------
    equilibrium
        Of the poorer model.
    richer, lin
        The same state in the richer model, and its linearisation.

    Raises
    ------
    NoEquilibriumError
        Where the system is singular.
    """
    dz, dmultipliers, dplaces = kkt_step(richer, lin)
    acting, size = equilibrium.obstacle.acting, abs(equilibrium.force)
    if acting is not None and not richer.sites:
        return _tip_change(richer, dz)
    if acting is not None:
        felt = acting.felt(equilibrium.state.axis)
        size = max(size, abs(complex(felt.forces.sum())), float(np.abs(felt.couples).sum()))
    change = lin.force_gradient @ dz + lin.force_multipliers @ dmultipliers + lin.force_places @ dplaces
    return float(abs(change) / max(size, NO_FORCE))


def _tip_change(state: State, dz: Array) -> float:
    """How far the tip moves with a change of the unknowns, relative to its deflection from the finger at rest."""
    rows = state.beam.rows(np.ones(1), np.array([state.beam.segments - 1]))
    rest = Axis.of(state.beam, np.zeros(state.z.size))
    deflection = abs(complex((rows.position @ (state.axis.direction - rest.direction))[0]))
    return float(abs((rows.position @ (state.axis.turning @ dz))[0]) / max(deflection, NO_FORCE))
