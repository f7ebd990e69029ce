"""Where a step leads: segments move along with the contacts that they end at, and their fields with them."""

from __future__ import annotations

import functools
from collections.abc import Sequence

import numpy as np

from gripper.arrays import Array
from gripper.beam.strains import Beam
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, Step

_SMALL = 1e-6  # of L
_FEWEST, _MOST = 4, 7  # equilibria through which a polynomial predicts the next one
_AGREE = 1e-3  # relative: what polynomials through one more or less may differ by
_NEAR = 1e-2  # of the tolerance, by L: a kink that far from its break costs less than is asked
_NARROW = 4e-5  # of the shortest segment, which a narrow patch may be: as much of it
_EXACT = 1e-7  # of the shortest segment: breaks this near are the same


def ends_at(beam: Beam, breaks: tuple[float, ...], tolerance: float) -> bool:
    """Whether the beam's segments end at these places (by L), as near as a tolerance of the forces asks."""
    if breaks == beam.breaks:
        return True
    if len(breaks) != len(beam.breaks):
        return False
    shortest = float(beam.lengths.min())
    near = max(min(_NEAR * tolerance, _NARROW * shortest), _EXACT * shortest)
    for wanted, there in zip(breaks, beam.breaks, strict=True):
        if not -near < wanted - there < near:
            return False
    return True


def advanced(setting: Setting, state: State, step: Step) -> State:
    """The state after a step in z (with the segments held still), the multipliers and the places.

    The segments move along with the contacts, and their fields with them.
    """
    moved = state.moved(*step)
    breaks = setting.breaks(moved.sites)
    if len(breaks) != len(state.beam.breaks) or ends_at(state.beam, breaks, setting.tolerance):
        return moved
    carried = state.beam.convection(state.fields, np.array(breaks) - state.beam.breaks)
    return _carried(setting, moved, breaks, state.beam.coefficients(moved.z) + carried)


def _carried(setting: Setting, state: State, breaks: tuple[float, ...], fields: Array) -> State:
    """The state with these fields on segments that end elsewhere."""
    beam = state.beam
    if breaks != beam.breaks:
        beam = Beam(setting.sections, breaks, beam.order, setting.theory)
    z = beam.unknowns(fields, state.beam.base_turn(state.z))
    return State(beam, z, state.sites, state.multipliers)


def predicted(
    setting: Setting, now: Equilibrium, change: float, last: tuple[Equilibrium, float] | None = None
) -> State:
    """The state a change of the parameter further: along the tangent, bent as it has turned since the last one.

    Parameters
    ----------
    setting, now
        Where it starts.
    change
        Of the parameter.
    last
        An earlier equilibrium of the same contacts, and how far back on the parameter.

    Raises
    ------
    NoEquilibriumError
        At a limit point, where the tangent is vertical.
    """
    try:
        rates = now.tangent()
        before = last[0].tangent() if last else rates
    except np.linalg.LinAlgError as error:
        raise NoEquilibriumError("the tangent is vertical (a limit point)") from error
    if last is None:
        return advanced(setting, now.state, (change * rates[0], change * rates[1], change * rates[2]))
    then, back = last
    turned = change**2 / 2 / back
    bent = [change * rate + turned * (rate - old) for rate, old in zip(rates[1:], before[1:], strict=True)]
    moved = now.state.moved(change * rates[0], *bent)
    breaks = setting.breaks(moved.sites)
    if len(breaks) != len(now.state.beam.breaks):
        return moved
    flow, old_flow = _flow(setting, now), _flow(setting, then)
    # the tangent is that of segments held still, which cannot follow the kinks exactly: off by as much as it was before
    off = (now.state.fields - then.state.fields) / back - (flow + old_flow) / 2
    return _carried(setting, moved, breaks, now.state.fields + change * (flow + off) + turned * (flow - old_flow))


def extrapolated(setting: Setting, trail: Sequence[tuple[float, Equilibrium]], parameter: float) -> State | None:
    """The state at a value of the parameter, by the polynomial through the last equilibria of the same contacts.

    Of as many of these as agree best with one fewer: where the branch is smooth, its error is far below a tangent's.

    Parameters
    ----------
    setting, trail
        Where they are, and what they are: the last one first, all with the same unknowns.
    parameter
        Where to.

    Returns
    -------
    State | None
        None where they are too few, or do not agree.
    """
    away = [at - parameter for at, _ in trail[:_MOST]]
    if len(trail) < _FEWEST or len(set(away)) < len(away):  # two at one place: no polynomial passes through them
        return None
    known = np.array([equilibrium.state.followed for _, equilibrium in trail[:_MOST]])
    guesses = _lagrange(away) @ known
    between = guesses[1:] - guesses[:-1]
    apart = np.einsum("kn,kn->k", between, between)
    best = int(apart.argmin())
    if not apart[best] < (_AGREE * _AGREE) * (known[0] @ known[0]):
        return None
    now, guess = trail[0][1].state, guesses[best + 1]
    count = now.fields.size
    middle = count + now.multipliers.size
    moved = State(now.beam, now.z, now.placed(guess[middle:]), guess[count:middle])
    breaks = setting.breaks(moved.sites)
    if len(breaks) != len(now.beam.breaks):
        return None
    return _carried(setting, moved, breaks, guess[:count].reshape(now.fields.shape))


def _lagrange(away: list[float]) -> Array:
    """Weights of the values at these abscissae in the polynomials' values at 0, through the first 3, 4, ... of them."""
    weights = [1.0]
    rows = [[1.0] + [0.0] * (len(away) - 1)]
    for count, last in enumerate(away[1:], start=1):
        weights.append(1.0)
        for i, x in enumerate(away[:count]):
            weights[i] *= last / (last - x)
            weights[count] *= x / (x - last)
        rows.append(weights + [0.0] * (len(away) - count - 1))
    return np.array(rows[2:])


@functools.lru_cache(maxsize=8)  # where a step ends the next one starts
def _flow(setting: Setting, equilibrium: Equilibrium) -> Array:
    """Rates of the fields' coefficients, the segments moving with the contacts: (fields, segments, p + 1)."""
    state, (dz, _, dplaces) = equilibrium.state, equilibrium.tangent()
    small = _SMALL / max(largest(dplaces), 1.0)
    moved = setting.breaks(state.placed(state.places + small * dplaces))
    breaks = setting.breaks(state.sites)
    known = len(moved) == len(breaks) == len(state.beam.breaks)
    moves = np.subtract(moved, breaks) / small if known else np.zeros(len(state.beam.breaks))
    return state.beam.coefficients(dz) + state.beam.convection(state.fields, moves)


def largest(values: Array) -> float:
    """The largest of a few in size."""
    return max(map(abs, values.tolist()), default=0.0)
