"""From a free pose straight to a pose in contact, where Newton's method proves on the way that it keeps to its branch.

The finger is bent about the place that sinks deepest into the object by the step of Newton's method that closes this
gap. Waypoints follow: at each, one step of Newton's method from where the tangent has led, and the tangent to the next
one together. The one contact that was followed is the pose's active set if its equilibrium verifies: no pull, nothing
inside over the whole outline, stable. In any doubt (a correction that is not small against its step, a second place
that touches) there is no leap: the way is gone step by step, and SLSQP names the active set.
"""

from __future__ import annotations

import math

import numpy as np

from gripper.contact.kinematics import Retreat
from gripper.contact.linear import linearise
from gripper.contact.linearisation import Linearisation
from gripper.contact.obstacle import Obstacle
from gripper.contact.outline import UPPER, dot
from gripper.contact.site import Site
from gripper.statics.certificate import Survey, survey
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, Step, kkt_step, reckoned
from gripper.statics.nearby import sampled_gap
from gripper.statics.sampling import DEPTH
from gripper.statics.settling import settle_contacts
from gripper.statics.steps import advanced, largest
from gripper.statics.verified import Verified, objection, verify

_BEYOND = 0.6  # of the pace: how far beyond the estimated touch to look
_NEARLY = 0.98  # of it
_LONGEST = 0.2  # of L: between waypoints
_MOST = 30  # of them
_FACING = 0.1  # least cosine between the contact's normal and the object's way
_DEPARTS = 0.5  # of a step: what it may differ from its prediction
_FIRST = 1.3  # by as much more may the first step, which knows of no force yet
_FURTHEST = 0.1  # of L: the most that a place moves in a step
_ASIDE = 0.15  # of L: what touches further from the contact is another one
_CLOSE = 0.1  # relative: near enough for the last steps of Newton's method
_SPREADS = 0.05  # relative: what a patch in the place of a point may change
_ROUNDS = 4  # in which it must come that close


def leaps(setting: Setting) -> bool:
    """Whether a way may be leapt: a smooth object, and nothing else that bends the finger."""
    return setting.friction is None and setting.loads is None and not len(setting.body.corners)


def leap(setting: Setting, path: Retreat, free: Verified, sunk: float) -> Verified | None:
    """The equilibrium at the end of an approach (parameter 0); None where it is to be gone step by step.

    Parameters
    ----------
    setting, path
        Finger, theory, object, and the object's way.
    free
        The straight finger, free of the object.
    sunk
        A parameter less than a pace further on, where it is not.
    """
    try:
        with reckoned():
            return _leapt(setting, path, free.equilibrium.state, sunk)
    except NoEquilibriumError:
        return None


def _leapt(setting: Setting, path: Retreat, straight: State, parameter: float) -> Verified:
    state, length = _closed(setting, setting.obstacle(path.frame(parameter)), straight, path.direction)
    pace = min(setting.body.inner_radius / setting.sections.length, _LONGEST)
    if -parameter > _MOST * pace:
        raise NoEquilibriumError("the way is long for an object this small")
    for ahead in range(math.ceil(-parameter / pace), 0, -1):
        state, length = _onward(setting, setting.obstacle(path.frame(parameter)), state, -parameter / ahead, length)
        parameter -= parameter / ahead
        if ahead > 1:
            _check_alone(setting, state, survey(setting, setting.obstacle(path.frame(parameter)), state, brief=True))
    return _arrived(setting, setting.obstacle(path.frame(0.0)), state, length)


def met(
    setting: Setting,
    path: Retreat,
    straight: State,
    free: tuple[float, float],
    sunk: tuple[float, float],
    pace: float,
) -> tuple[float, tuple[float, float]]:
    """Nearer to the first touch: how far back the finger is free, and a place within a pace of it where it is not.

    Parameters
    ----------
    setting, path, straight
        Finger, object, its way, and the finger that it does not touch.
    free, sunk
        A parameter at which it is free, one further on at which it is not, and the sampled gaps there.
    pace
        How far (by L) the object may move from a free pose into the straight finger.
    """
    one, other = sunk, free
    while sunk[0] - free[0] > pace:
        low, high = free[0], sunk[0]
        fall = (one[1] - other[1]) / (one[0] - other[0])
        touch = other[0] - other[1] / fall if fall < 0 else low
        further = min(max(touch, low) + _BEYOND * pace, high - _BEYOND * pace)
        place = further if further < high - pace else high - _NEARLY * pace
        one, other = other, (place, sampled_gap(setting, setting.obstacle(path.frame(place)), straight))
        free, sunk = (other, sunk) if other[1] >= -DEPTH else (free, other)
    return -free[0], sunk


def _closed(setting: Setting, obstacle: Obstacle, straight: State, way: complex) -> tuple[State, float]:
    """The straight finger bent such that its deepest gap closes, to first order, and how far that is in z."""
    found = survey(setting, obstacle, straight, brief=True)
    sides = [(piece, u) for piece, u in found.deepest if setting.outline.pieces[piece].on != "tip"]
    if not sides:
        raise NoEquilibriumError("met on its end face the finger is a strut")
    # beside a corner that has sunk in, too, a face rather bends until it lies on the object than stands on its corner
    piece, u = min(sides, key=lambda side: setting.outline.corner_at(*side) is not None)
    corner = setting.outline.corner_at(piece, u)
    site = Site("tangent", piece, (u,)) if corner is None else Site("corner", corner, ())
    beam = setting.beam((site,), straight.beam.order)
    state = State(beam, np.zeros(beam.size), (site,), np.zeros(1))
    _check_alone(setting, state, found)
    lin = _linear(setting, obstacle, state)
    normal = complex(lin.force_multipliers[0])
    if dot(np.array([normal]), np.array([way]))[0] < _FACING * abs(normal):
        raise NoEquilibriumError("the object does not push the way it comes")
    step = kkt_step(state, lin)
    return _taken(setting, obstacle, state, lin, step), _FIRST * _size(step)


def _check_alone(setting: Setting, state: State, found: Survey) -> None:
    """Raise where the object is also in what is not beside the only contact."""
    site = state.sites[0]
    if found.engulfed or found.sunken:
        raise NoEquilibriumError("the object is in the finger")
    others = [(p, u) for p, u in found.deepest if p != site.piece or abs(u - site.middle) > _ASIDE]
    if not others:
        return
    pieces, u = (np.array(values) for values in zip((site.piece, site.middle), *others, strict=True))
    last = np.full(pieces.size, state.beam.segments - 1)
    segments = np.where(pieces <= UPPER, state.beam.segment_of(np.clip(u, 0.0, 1.0)), last)
    points = setting.outline.trace(state.axis, pieces, u, segments)[0]
    if np.any(np.abs(points - points[0]) > _ASIDE):
        raise NoEquilibriumError("something else touches")


def _onward(setting: Setting, obstacle: Obstacle, state: State, way: float, length: float) -> tuple[State, float]:
    """A step of Newton's method and one along the tangent: the state further on, and the tangent's length in z."""
    lin = _linear(setting, obstacle, state)
    correction = kkt_step(state, lin)
    if _size(correction) > _DEPARTS * length:
        raise NoEquilibriumError("the step departs from its prediction")
    rates = Equilibrium(state, obstacle, lin, 0).tangent()
    ahead = (way * rates[0], way * rates[1], way * rates[2])
    step = (correction[0] + ahead[0], correction[1] + ahead[1], correction[2] + ahead[2])
    return _taken(setting, obstacle, state, lin, step), _size(ahead)


def _arrived(setting: Setting, obstacle: Obstacle, state: State, length: float) -> Verified:
    """The equilibrium beside a state: Newton's method with its point of contact comes close, then it settles."""
    for _ in range(_ROUNDS):
        lin = _linear(setting, obstacle, state)
        step = kkt_step(state, lin)
        if _size(step) > _DEPARTS * length:
            raise NoEquilibriumError("the step departs from its prediction")
        state, length = _taken(setting, obstacle, state, lin, step), _size(step)
        size = float(np.linalg.norm(state.z))
        if length < _CLOSE * size:
            break
    else:
        raise NoEquilibriumError("Newton's method does not come close soon")
    settled = settle_contacts(setting, obstacle, state, state.beam.order, judged=True, known=lin)
    if settled.correction > max(_DEPARTS * length, _SPREADS * size):
        raise NoEquilibriumError("the step departs from its prediction")
    return verify(setting, settled)


def _linear(setting: Setting, obstacle: Obstacle, state: State) -> Linearisation:
    return linearise(state.beam, state.z, setting.outline, obstacle, state.sites, state.multipliers)


def _taken(setting: Setting, obstacle: Obstacle, state: State, lin: Linearisation, step: Step) -> State:
    """The state after a step, where its contact keeps its place and presses."""
    if largest(step[2]) > _FURTHEST:
        raise NoEquilibriumError("a contact runs away")
    moved = advanced(setting, state, step)
    reason = objection(setting, Equilibrium(moved, obstacle, lin, 0))
    if reason:
        raise NoEquilibriumError(reason)
    return moved


def _size(step: Step) -> float:
    return float(np.linalg.norm(step[0]))
