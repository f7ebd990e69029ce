"""Friction that SLSQP finds by itself, to compare with: per pose a Tresca problem, its normal force updated.

At a pose the strain energy and the work of friction against a given normal force are least,

    min V(z) + mu N (a + b)   such that   g = 0,  dg/du = 0,  slip(z, u) = a - b,  a >= 0,  b >= 0,

slip being the way along the object less the way along the finger since the last pose. N is set to the normal force that
comes out until it stays (by secants). Slip, stick and sense are then SLSQP's, and belong to the net slip of the step.
One contact, on a smooth stretch of the object; the same discretisation and contact equations as this project's.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import minimize

from gripper.arrays import Array
from gripper.contact.linear import linearise
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.site import Site
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State

_SETTLED = 1e-7  # relative: what the normal force may still change by
_ROUNDS = 40
_FLOOR = 1e-14


@dataclass(frozen=True, eq=False)
class Held:
    """A pose of the Tresca problem.

    Parameters
    ----------
    force
        On the object, in N, clamp's axes.
    slip
        Net slip of the finger along t since the last pose, by L.
    rounds
        How many problems SLSQP solved.
    """

    force: complex
    slip: float
    rounds: int


class Tresca:
    """Follows a contact, pose by pose.

    Parameters
    ----------
    setting
        With friction, theory bending.
    start
        Where it starts: an equilibrium with one contact, a tangent one.

    Raises
    ------
    ValueError
        Another contact than that.
    """

    def __init__(self, setting: Setting, start: Equilibrium) -> None:
        sites, rubbing = start.state.sites, start.linear.rubbing
        if [site.kind for site in sites] != ["tangent"] or rubbing is None:
            raise ValueError(f"start must have one contact, on a smooth stretch; got {[site.kind for site in sites]}")
        self.setting, self.state = setting, start.state
        self.anchor = rubbing.anchors[0]
        self.normal = float(abs(start.linear.forces[0][0] / (1 - 1j * rubbing.ratios[0])))

    def pose(self, obstacle: Obstacle) -> Held:
        """Go on to a pose of the object.

        Raises
        ------
        NoEquilibriumError
            Where the normal force does not settle.
        """
        bounds: list[tuple[float, float]] = []  # normal forces that were given, and came out
        given = self.normal
        for rounds in range(1, _ROUNDS + 1):
            state, lin, load, push, slip = self._solved(obstacle, given)
            came = load * float(abs(lin.forces[0][0]))
            bounds.append((given, came))
            if abs(came - given) < _SETTLED * came:
                self.state, self.normal = state, came
                n = complex(lin.forces[0][0]) / abs(complex(lin.forces[0][0]))
                ended = linearise(state.beam, state.z, self.setting.outline, obstacle, state.sites, np.array([load]))
                if ended.rubbing is not None:
                    self.anchor = ended.rubbing.anchors[0]
                return Held(-(came - 1j * push) * n * self.setting.sections.force_scale, slip, rounds)
            given = _secant(bounds)
        raise NoEquilibriumError(f"the normal force does not settle in {_ROUNDS} rounds")

    def _solved(self, obstacle: Obstacle, normal: float) -> tuple[State, Linearisation, float, float, float]:
        """The Tresca problem: state, linearisation, multiplier of the gap, friction along t, and slip."""
        (site,) = self.state.sites
        if site.grip is None:
            raise ValueError("the contact must have friction; got none")
        grip = replace(site.grip, hold="stick", sense=0, anchor=self.anchor, ratio=0.0)
        held = replace(site, grip=grip)
        beam = self.setting.beam((held,), self.state.beam.order)
        z, n = self.state.on(beam).z, beam.size
        bound = grip.law.at(site.piece, site.middle)[0] * normal

        def read(x: Array) -> Linearisation:
            return linearise(beam, x[:n], self.setting.outline, obstacle, (_at(held, x[n]),), np.ones(1))

        at = _remembered(read)
        slip = float(at(np.append(z, site.place)).residuals[1])
        x0 = np.concatenate([z, site.place, [max(slip, 0.0), max(-slip, 0.0)]])
        answer: Any = minimize(
            lambda x: x[:n] @ x[:n] / 2 + bound * (x[n + 1] + x[n + 2]),
            x0,
            jac=lambda x: np.concatenate([x[:n], [0.0, bound, bound]]),
            method="SLSQP",
            constraints={
                "type": "eq",
                "fun": lambda x: _values(at(x[: n + 1]), x),
                "jac": lambda x: _rows(at(x[: n + 1])),
            },
            bounds=[(None, None)] * (n + 1) + [(0.0, None)] * 2,
            options={"ftol": _FLOOR, "maxiter": 100},
        )
        x, (load, _, push) = answer.x, answer.multipliers
        state = State(beam, x[:n], (_at(held, x[n]),), np.array([load]))
        return state, at(x[: n + 1]), float(load), float(push), float(x[n + 1] - x[n + 2])


def _at(site: Site, u: float) -> Site:
    return replace(site, place=(float(u),))


def _remembered(read: Callable[[Array], Linearisation]) -> Callable[[Array], Linearisation]:
    """Constraints and their gradients are asked for one after the other at the same place."""
    kept = functools.lru_cache(maxsize=2)(lambda key: read(np.frombuffer(key)))
    return lambda x: kept(x.tobytes())


def _values(lin: Linearisation, x: Array) -> Array:
    """Gap, its slope, and slip less its two parts."""
    return np.array([lin.values[0], lin.residuals[0], lin.residuals[1] - (x[-2] - x[-1])])


def _rows(lin: Linearisation) -> Array:
    """Gradients of these by z, the place and both parts of slip."""
    slopes = np.concatenate([lin.value_slopes[0, :1], lin.residual_slopes[:, 0]])
    own = np.concatenate([lin.gradients, lin.residual_gradients])
    return np.column_stack([own, slopes, [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])


def _secant(known: list[tuple[float, float]]) -> float:
    """The next normal force: where the last two differences between given and found lead to none."""
    (last, came), *before = reversed(known)
    if not before:
        return came
    old, found = before[0]
    fall = (came - last) - (found - old)
    return last - (came - last) * (last - old) / fall if abs(fall) > abs(came - last) / 10 else came
