"""Where a step leads: segments move along with the contacts that they end at, and their fields with them."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np

from gripper.arrays import Array
from gripper.beam.strains import Beam
from gripper.statics.equilibrium import Equilibrium, NoEquilibriumError, Setting, State, Step

_SMALL = 1e-6  # of L
_EXACT = 1e-7  # of the shortest segment: breaks this near are the same


def ends_at(beam: Beam, breaks: tuple[float, ...]) -> bool:
    """Whether the beam's segments end at these places (by L)."""
    if len(breaks) != len(beam.breaks):
        return False
    return bool(np.abs(np.subtract(breaks, beam.breaks)).max() < _EXACT * beam.lengths.min())


def advanced(setting: Setting, state: State, step: Step) -> State:
    """The state after a step in z (with the segments held still), the multipliers and the places.

    The segments move along with the contacts, and their fields with them.
    """
    moved = state.moved(*step)
    breaks = setting.breaks(moved.sites)
    if len(breaks) != len(state.beam.breaks) or ends_at(state.beam, breaks):
        return moved
    moves = np.array(breaks) - state.beam.breaks
    carried = state.beam.convection(state.z, moves)
    return _carried(setting, moved, breaks, state.beam.coefficients(moved.z) + carried)


def _carried(setting: Setting, state: State, breaks: tuple[float, ...], fields: Array) -> State:
    """The state with these fields on segments that end elsewhere."""
    beam = state.beam
    if breaks != beam.breaks:
        beam = Beam(setting.sections, breaks, beam.order, setting.theory)
    return replace(state, beam=beam, z=beam.unknowns(fields, state.beam.base_turn(state.z)))


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


@functools.lru_cache(maxsize=8)  # where a step ends the next one starts
def _flow(setting: Setting, equilibrium: Equilibrium) -> Array:
    """Rates of the fields' coefficients, the segments moving with the contacts: (fields, segments, p + 1)."""
    state, (dz, dmultipliers, dplaces) = equilibrium.state, equilibrium.tangent()
    small = _SMALL / max(largest(dplaces), 1.0)
    moved = setting.breaks(state.moved(0 * dz, 0 * dmultipliers, small * dplaces).sites)
    moves = (
        np.subtract(moved, state.beam.breaks) / small if len(moved) == len(state.beam.breaks) else 0 * state.beam.starts
    )
    return state.beam.coefficients(dz) + state.beam.convection(state.z, moves)


def largest(values: Array) -> float:
    """The largest of a few in size."""
    return max(map(abs, values.tolist()), default=0.0)
