"""The equilibrium at which one of its unknowns has a given value, wherever on the path that is.

The parameter q is one unknown more of Newton's method, x_k = c one equation more. With the KKT matrix K, what is left F
of its equations and their rates F_q by the parameter,

    K a = -F,   K t = -F_q,   dq = (c - x_k - a_k) / t_k,   dx = a + t dq:

an event is located, and its equilibrium known, at the cost of one equilibrium.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.linear import linearise
from gripper.contact.obstacle import Obstacle
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, solved
from gripper.statics.steps import advanced, largest

_ROUNDS = 5  # four suffice; where they do not the equations are all but singular
_CONVERGED = 1e-5  # last step, relative, the parameter's by the way: the next one, of second order, would be round-off
_SETTLED = 1e-9  # what may then be left of the equations, relative
_FURTHEST = 0.15  # of L: the most that a place moves in a step of Newton's method
_NO_STRAIN = 1e-8  # |z| below which steps are judged by their own size


@dataclass(frozen=True)
class Pin:
    """What is given: one of the multipliers or of the places, which are counted after them, and its value."""

    unknown: int
    value: float


def pinned(
    setting: Setting,
    obstacle: Callable[[float], Obstacle],
    start: tuple[float, Equilibrium],
    pin: Pin,
    ends: tuple[float, float],
) -> tuple[float, Equilibrium, float]:
    """Where an unknown has its value, the equilibrium there, and how far (in z) the tangent at the start leads.

    Parameters
    ----------
    setting, obstacle
        The object at a value of the parameter.
    start
        A value of the parameter, and the equilibrium there.
    pin
        What is given.
    ends
        Between which the parameter is looked for.

    Raises
    ------
    NoEquilibriumError
        Where Newton's method does not find it between them.
    """
    at, now = start
    if any(site.lifts_off for site in now.state.sites):
        raise NoEquilibriumError("places that answer to steps unevenly")
    size, last, expected, way = float(np.linalg.norm(now.state.z)) + _NO_STRAIN, math.inf, 0.0, 0.0
    low, high = min(ends), max(ends)
    for rounds in range(_ROUNDS + 1):
        left = _left(now)
        if last < _CONVERGED and float(np.linalg.norm(left)) < _SETTLED * size:
            return at, replace(now, correction=way), expected
        step, rates, change = _step(now, left, pin)
        following = min(max(at + change, low), high)
        if following == at != at + change:
            break
        step += (following - at) * rates
        state = _stepped(setting, now.state, step)
        lin = linearise(state.beam, state.z, setting.outline, obstacle(following), state.sites, state.multipliers)
        at, now = following, Equilibrium(state, obstacle(following), lin, rounds + 1)
        length = float(np.linalg.norm(step[: state.z.size]))
        expected, way = (expected, way + length) if rounds else (length, 0.0)
        last = max(length / size, largest(step[state.z.size + state.multipliers.size :]), abs(change) / (high - low))
    raise NoEquilibriumError("no place between the ends is found where it is so")


def _left(at: Equilibrium) -> Array:
    """What is left of the equations, (n + m + k,)."""
    state, lin = at.state, at.linear
    return np.concatenate([state.energy_gradient - lin.load(state.multipliers), lin.values, lin.residuals])


def _step(at: Equilibrium, left: Array, pin: Pin) -> tuple[Array, Array, float]:
    """Newton's step at this parameter, the rates by it, and the change of it that leads to the value.

    Raises
    ------
    NoEquilibriumError
        Where the value does not answer to the parameter, or the system is singular.
    """
    state = at.state
    both = solved(at.matrix(), np.array([-left, at.passing()], order="F").T)
    if both is None:
        raise NoEquilibriumError("the KKT system is singular (parallel constraints)")
    unknown = state.z.size + pin.unknown
    known = float(np.concatenate([state.multipliers, state.places])[pin.unknown])
    step, rate = float(both[unknown, 0]), float(both[unknown, 1])
    if not rate:
        raise NoEquilibriumError("what is given does not answer to the parameter")
    return both[:, 0], both[:, 1], (pin.value - known - step) / rate


def _stepped(setting: Setting, state: State, step: Array) -> State:
    """The state after a step in all unknowns.

    Raises
    ------
    NoEquilibriumError
        Where a place runs away, or a patch shrinks to nothing.
    """
    n, m = state.z.size, state.multipliers.size
    if largest(step[n + m :]) > _FURTHEST:
        raise NoEquilibriumError("a contact runs away")
    moved = advanced(setting, state, (step[:n], step[n : n + m], step[n + m :]))
    if any(site.spreads and site.place[0] >= site.place[1] for site in moved.sites):
        raise NoEquilibriumError("a patch has shrunk to nothing")
    breaks = setting.breaks(moved.sites)
    return moved if len(breaks) == len(moved.beam.breaks) else moved.on(setting.beam(moved.sites, moved.beam.order))
