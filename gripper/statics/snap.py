"""Beyond a limit point: a damped descent, small step by small step, from the last equilibrium to the next."""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize

from gripper.arrays import Array, Complex
from gripper.contact.obstacle import Obstacle
from gripper.statics.active import find
from gripper.statics.certificate import survey
from gripper.statics.equilibrium import NoEquilibriumError, Setting, State
from gripper.statics.nearby import near
from gripper.statics.problem import Problem
from gripper.statics.verified import Verified

_STEPS = 150
_TRIES = 3
_EFFORT = 4000  # evaluations of the gaps
_UNDAMPED = 1e-3  # damping at which the steps are as good as free
_LONGEST = 0.02  # of L: no point of the axis moves further in a step, so that nothing is passed through
_REST = 1e-6  # of L: the finger has come to rest
_MARKS = np.linspace(0.125, 1.0, 8)


def axis_points(state: State) -> Complex:
    """Points of the axis (8,), by L: how states are compared."""
    return state.axis.values(_MARKS, state.beam.segment_of(_MARKS))[0]


def distance(a: State, b: State) -> float:
    """Largest distance between the axes of two states, by L."""
    return float(np.max(np.abs(axis_points(a) - axis_points(b))))


def descend(setting: Setting, obstacle: Obstacle, start: State, order: int) -> Verified:
    """Follow the overdamped motion of the released finger: each step minimises V + rho |z - z_k|^2 / 2, gaps >= 0.

    Raises
    ------
    NoEquilibriumError
        Where it does not come to rest, or not in an equilibrium that verifies.
    """
    beam = setting.beam((), order)
    state = State(beam, beam.project(start.beam, start.z))
    damping, reason, tries, effort = 1.0, "the finger does not come to rest", 0, 0
    for _ in range(_STEPS):
        following, evaluations = _damped_step(setting, obstacle, state, damping)
        effort += evaluations
        if effort > _EFFORT:
            break
        moved = distance(state, following)
        if moved > _LONGEST and damping < 1e6:
            damping *= 4
            continue
        state = following
        if (moved < _REST or damping < _UNDAMPED) and tries < _TRIES:
            tries += 1
            try:
                return find(setting, obstacle, state, order)
            except NoEquilibriumError as error:
                reason, effort = str(error), effort + error.effort
            if moved < _REST:
                break
        if moved < _LONGEST / 4:
            damping /= 2
    raise NoEquilibriumError(f"after a snap: {reason}", effort)


def _damped_step(setting: Setting, obstacle: Obstacle, state: State, damping: float) -> tuple[State, int]:
    found = survey(setting, obstacle, state)
    problem = Problem(setting, obstacle, state, near(setting, obstacle, state, found, 0.1))
    arguments = problem.scipy(1e-9)
    x0 = problem.x0

    def dissipating(x: Array) -> tuple[float, Array]:
        away = x - x0
        stored, stress = problem.scaled_energy(x)
        return stored + damping * float(away @ away) / 2, stress + damping * away

    answer = minimize(**{**arguments, "fun": dissipating})
    return problem.state(answer.x), int(answer.nfev)
