"""One set of contacts along a motion: its equilibria between two poses, wherever they are asked for."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.optimize import brentq

from gripper.contact.features import Feature, features
from gripper.contact.linear import linearise
from gripper.contact.obstacle import Frame, Obstacle
from gripper.motion.pinned import Pin, pinned
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State
from gripper.statics.newton import settle
from gripper.statics.rolling import strongest_alone
from gripper.statics.snap import distance
from gripper.statics.steps import extrapolated, predicted

_ROUND_OFF = 1e-13
_HALVINGS = 4  # of a way along a branch
_DEPARTS = 0.5  # of a step: what it may differ from its prediction
APART = 1e-4
"""Of L: shapes that differ by more are of different branches."""
_SMALL = 1e-5  # of L: the step along the tangent
_GENTLE, _GENTLEST = 0.1, 1e-4  # of the forces, what such a step changes; of the step, what is left of it
STILL = 1e-12
"""Of L: object and clamp do not move against each other."""
SHARP = 1e-10  # of the step: where an event is located to


class Path(Protocol):
    """Frames of the object along a parameter."""

    def frame(self, parameter: float) -> Frame:
        """The object's frame relative to the clamp."""
        ...

    def __hash__(self) -> int:
        """By identity: what was reached on it is kept."""
        ...


@dataclass(frozen=True, eq=False)
class Along:
    """An equilibrium and where on the path it stands."""

    parameter: float
    equilibrium: Equilibrium


class Branch:
    """The equilibria of one set of contacts near a known one, each reached from the nearest that is known."""

    def __init__(self, setting: Setting, path: Path, known: Along, order: int) -> None:
        self.setting, self.path, self.order = setting, path, order
        self.known = [known]

    def at(self, parameter: float) -> Equilibrium:
        """The equilibrium at a parameter.

        Raises
        ------
        NoEquilibriumError
            Where Newton does not reach it.
        """
        return self._reached(parameter, _HALVINGS)

    def know(self, others: Iterable[Along]) -> None:
        """Take in more equilibria of the branch."""
        for at in others:
            if all(at.parameter != known.parameter for known in self.known):
                self.known.append(at)

    def _guess(self, start: Along, parameter: float) -> State:
        """The state at a parameter: by the polynomial through those nearest to it; along the tangent where few are."""
        if len(self.known) > 1:
            kinds = start.equilibrium.state.kinds
            near = [(at.parameter, at.equilibrium) for at in self.known if at.equilibrium.state.kinds == kinds]
            near.sort(key=lambda at: abs(at[0] - parameter))
            guess = extrapolated(self.setting, near, parameter)
            if guess is not None:
                return guess
        return predicted(self.setting, start.equilibrium, parameter - start.parameter)

    def _reached(self, parameter: float, halvings: int) -> Equilibrium:
        start = min(self.known, key=lambda at: abs(at.parameter - parameter))
        if start.parameter == parameter:
            return start.equilibrium
        guess = self._guess(start, parameter)
        expected = float(np.linalg.norm(guess.z - start.equilibrium.state.z))
        try:
            found = settle(self.setting, self._obstacle(parameter), guess, self.order)
        except NoEquilibriumError:
            if not halvings:
                raise
            halvings = 1  # a narrow patch's places are near to its prediction's, or hardly found
        else:
            if found.correction <= _DEPARTS * expected + APART:
                self.known.append(Along(parameter, found))
                return found
        if not halvings:
            raise NoEquilibriumError("the step departs from its prediction")
        self._reached((start.parameter + parameter) / 2, halvings - 1)
        return self._reached(parameter, halvings - 1)

    def pinned(self, start: float, pin: Pin, ends: tuple[float, float]) -> float | None:
        """Where an unknown has a given value, from the equilibrium at a parameter; None where Newton does not say."""
        try:
            known = self.at(start)
            where, found, expected = pinned(self.setting, self._obstacle, (start, known), pin, ends)
        except NoEquilibriumError:
            return None
        if found.correction > _DEPARTS * expected + APART:
            return None
        self.known.append(Along(where, found))
        return where

    def _obstacle(self, parameter: float) -> Obstacle:
        return self.setting.obstacle(self.path.frame(parameter))


def branch_from(setting: Setting, path: Path, known: Along, order: int) -> Branch:
    """The branch of a known equilibrium, with all that was reached on it: an event is asked for again and again."""
    return _branch(setting, path, known.equilibrium, known.parameter, order)


@functools.lru_cache(maxsize=64)  # those of a motion's events, until its extremes are located at its end
def _branch(setting: Setting, path: Path, equilibrium: Equilibrium, parameter: float, order: int) -> Branch:
    return Branch(setting, path, Along(parameter, equilibrium), order)


def speed(equilibrium: Equilibrium) -> float:
    """How fast object and clamp move against each other, by L per unit of the parameter."""
    frame = equilibrium.obstacle.frame
    return abs(frame.velocity) + abs(frame.spin)


def nudged(setting: Setting, path: Path, at: Along, heading: float) -> tuple[Equilibrium, float]:
    """The state a little further along the tangent, and how far; 0 where object and clamp do not move.

    Raises
    ------
    NoEquilibriumError
        At a limit point.
    """
    equilibrium = at.equilibrium
    fast = speed(equilibrium)
    if fast < STILL:
        return equilibrium, 0.0
    small = heading * _SMALL / fast
    state = predicted(setting, equilibrium, small)
    loads = [(old[0], new[0] - old[0]) for old, new in zip(equilibrium.state.loads, state.loads, strict=True)]
    least = min((abs(load / change) for load, change in loads if change), default=1.0)
    if least < _GENTLE:  # just touched: the ratio of a contact that sticks changes as fast as its force grows
        small *= max(_GENTLE * least, _GENTLEST)
        state = predicted(setting, equilibrium, small)
    obstacle = setting.obstacle(path.frame(at.parameter + small))
    lin = linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers)
    return Equilibrium(state, obstacle, lin, 0), small


def pointed(setting: Setting, equilibrium: Equilibrium, order: int) -> Equilibrium:
    """All patches as points, and the strongest alone of neighbouring corners of the object."""
    equilibrium = strongest_alone(setting, equilibrium, order)
    for i in range(len(equilibrium.state.sites)):
        equilibrium = pointed_at(setting, equilibrium, i, order)
    return equilibrium


@functools.lru_cache(maxsize=16)
def pointed_at(setting: Setting, equilibrium: Equilibrium, i: int, order: int) -> Equilibrium:
    """A patch shrinks to a point before it lets go: followed as a point, which may pull beyond the event."""
    site = equilibrium.state.sites[i]
    if site.kind != "patch":
        return equilibrium
    state = equilibrium.state
    first = sum(s.multipliers for s in state.sites[:i])
    sites = (*state.sites[:i], replace(site, kind="tangent", place=(site.middle,), modes=1), *state.sites[i + 1 :])
    multipliers = np.delete(state.multipliers, range(first + 1, first + site.multipliers))
    return settle(setting, equilibrium.obstacle, State(state.beam, state.z, sites, multipliers), order)


def joined(setting: Setting, path: Path, there: Along, known: Along, order: int, apart: float = APART) -> float:
    """Where an event is, once the branch of a known equilibrium is seen to meet the event's.

    Raises
    ------
    NoEquilibriumError
        Where they do not meet: the step leads to another branch.
    """
    other = branch_from(setting, path, known, order).at(there.parameter)
    if distance(there.equilibrium.state, other.state) > apart:
        raise NoEquilibriumError("the step leads to another branch")
    return there.parameter


def bracketed(value: Callable[[float], float], start: float, stop: float) -> float:
    """The root between two parameters.

    Raises
    ------
    NoEquilibriumError
        Where there is none.
    """
    first, last = value(start), value(stop)
    if abs(first) < _ROUND_OFF or abs(last) < _ROUND_OFF:
        return start if abs(first) < abs(last) else stop
    if first * last > 0:
        raise NoEquilibriumError("the step leads to another branch")
    known = {start: first, stop: last}  # which brentq asks for again

    def asked(parameter: float) -> float:
        return known[parameter] if parameter in known else value(parameter)

    return float(brentq(asked, start, stop, xtol=SHARP * abs(stop - start), rtol=1e-14))


def number(known: Along, feature: Feature) -> int:
    """Which of its sites a contact is."""
    return features(known.equilibrium.state.sites)[feature]
