"""The rates of an equilibrium in any direction: one linear system, its segments' ends moving with the contacts."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gripper.arrays import Array
from gripper.contact.outline import dot
from gripper.contact.site import pressure_rule
from gripper.sensitivity.flow import Change, Flow, flow, load_rates
from gripper.sensitivity.touching import Span, Touching


@dataclass(frozen=True, eq=False)
class Residual:
    """Rates of the equations: dV/dz - Q_z, C, R."""

    stationarity: Array  # (d, n)
    values: Array  # (d, m)
    places: Array  # (d, k)

    @property
    def stacked(self) -> Array:
        """All equations of each direction, (d, n + m + k)."""
        return np.concatenate([self.stationarity, self.values, self.places], axis=1)


@dataclass(frozen=True, eq=False)
class Rates:
    """The rates of an equilibrium: the whole change that it undergoes, and what follows."""

    change: Change
    flow: Flow
    solution: Array  # of unknowns z, multipliers and places, (d, n + m + k)
    system: Array  # its matrix
    sizes: tuple[int, int, int]

    @property
    def unknowns(self) -> Array:
        """Of z, (d, n)."""
        return self.solution[:, : self.sizes[0]]

    @property
    def multipliers(self) -> Array:
        """Of the contacts, (d, m)."""
        return self.solution[:, self.sizes[0] : self.sizes[0] + self.sizes[1]]

    @property
    def places(self) -> Array:
        """Of the contacts, (d, k)."""
        return self.solution[:, self.sizes[0] + self.sizes[1] :]


def residual(touching: Touching, change: Change) -> Residual:
    """How far a change puts the equations off."""
    geometry, moved = touching.geometry, flow(touching, change)
    stress = _weighted(touching, change, change.stresses, touching.sections.stress, touching.sections.stress_slopes)
    loads, turning = load_rates(touching, change, moved)
    base = change.base * (geometry.base or 0.0) * geometry.base_turn
    return Residual(
        geometry.pulled(stress @ geometry.rule.modes - loads, base - turning), *_contact(touching, change, moved)
    )


def _weighted(t: Touching, change: Change, rates: Array, values: Array, slopes: Array) -> Array:
    """Rates of weights times values (..., g) at the Gauss points, (d, ..., segments, q), from those at fixed places."""
    geometry = t.geometry
    lengths = np.diff(change.breaks, axis=1)
    moved = change.breaks[:, :-1, None] + lengths[:, :, None] * geometry.rule.along
    shape = (*values.shape[:-1], geometry.segments, geometry.count)
    ahead, wider = (v.reshape(len(v), *(1,) * (len(shape) - 2), *v.shape[1:]) for v in (moved, lengths[..., None]))
    whole = rates.reshape(-1, *shape) + slopes.reshape(shape) * ahead
    out: Array = (geometry.lengths[:, None] * whole + wider * values.reshape(shape)) * (geometry.rule.weights / 2)
    return out


def stored_rates(touching: Touching, change: Change) -> Array:
    """Rates of the strain energy at fixed strains, and of the base's at a fixed turn, (d,)."""
    geometry, sections = touching.geometry, touching.sections
    strained = _weighted(touching, change, change.densities, sections.density, sections.density_slopes)
    found: Array = strained.sum(axis=(1, 2)) + change.base * (geometry.base or 0.0) * geometry.base_turn**2 / 2
    return found


def _contact(t: Touching, change: Change, moved: Flow) -> tuple[Array, Array]:
    """Rates of C and R."""
    count = len(change.breaks)
    values, places = (np.zeros((count, size), like=t.points) for size in (t.rows, t.columns))
    slopes = dot(moved.normals, t.tangents) + dot(t.normal, moved.tangents)
    for span in t.spans:
        site, at = span.site, span.queries.start
        if site.spreads:
            mean = pressure_rule(site.modes, t.beam.order)[1]
            inner = slice(at, at + mean.shape[1])
            values[:, span.row : span.row + site.modes] = moved.gaps[:, inner] @ mean.T
            ends = slice(span.column, span.column + site.unknown_places)
            told = slopes if site.lifts_off else moved.gaps
            places[:, ends] = told[:, inner.stop : span.queries.stop]
        elif site.kind == "vertex":
            away, unit = moved.points[:, at] - change.vertices[:, at], t.tangents[at] / abs(t.tangents[at])
            values[:, span.row], places[:, span.column] = dot(t.press[at], away), dot(unit, away)
        else:
            values[:, span.row] = moved.gaps[:, at]
            if site.unknown_places:
                places[:, span.column] = slopes[:, at]
        if span.sticks:
            places[:, span.ratio] = slip_rates(t, span, change, moved)
    return values, places


def slip_rates(t: Touching, span: Span, change: Change, moved: Flow) -> Array:
    """Rates of the slip of a contact that sticks since it began to (:mod:`gripper.contact.rubbing`)."""
    stick, at = t.stick(span), span.queries
    along = dot(stick.tangents, moved.points[:, at]) - change.queries[:, at] * stick.stretches
    stretch = dot(stick.tangents, moved.tangents[:, at]) / 2
    rates: Array = (along - stick.ways * stretch) @ stick.weights + change.slips[:, span.ratio]
    return rates


def matrix(touching: Touching, placed: Array) -> Array:
    """The system's matrix in (z, multipliers, places), from the residual's rates by the places (places, n + m + k)."""
    lin = touching.equilibrium.linear
    n, m = lin.gradients.shape[1], len(lin.values)
    out = np.zeros((n + m + touching.columns,) * 2)
    out[:n, :n] = touching.equilibrium.state.energy_hessian - lin.hessian
    out[:n, n : n + m] = -lin.loads.T
    out[n : n + m, :n], out[n + m :, :n] = lin.gradients, lin.residual_gradients
    out[:, n + m :] = placed.T
    return out


def _placed(touching: Touching) -> Change:
    """One direction for each unknown place."""
    breaks, queries, ratios = touching.moves
    return replace(Change.none(touching, touching.columns), breaks=breaks, queries=queries, ratios=ratios)


def rates(touching: Touching, change: Change) -> Rates:
    """The rates of the equilibrium for changes of what is given."""
    off = residual(touching, _placed(touching).beside(change)).stacked
    system = matrix(touching, off[: touching.columns])
    return carried(touching, change, -np.linalg.solve(system, off[touching.columns :].T).T, system)


def carried(touching: Touching, change: Change, solution: Array, system: Array) -> Rates:
    """The rates of the equilibrium, from the rates of its unknowns, multipliers and places."""
    moving = whole(touching, change, solution)
    return Rates(
        moving, flow(touching, moving), solution, system, (touching.beam.size, touching.rows, touching.columns)
    )


def whole(touching: Touching, change: Change, solution: Array) -> Change:
    """A change with the rates (d, n + m + k) of unknowns, multipliers and places that it brings about."""
    first, last = touching.beam.size, touching.beam.size + touching.rows
    unknowns, multipliers, places = solution[:, :first], solution[:, first:last], solution[:, last:]
    breaks, queries, ratios = touching.moves
    weights = [touching.spread(s.site, multipliers[:, s.row : s.row + s.site.multipliers]) for s in touching.spans]
    coefficients, turns = touching.geometry.pushed(unknowns)
    return replace(
        change,
        breaks=change.breaks + places @ breaks,
        queries=change.queries + places @ queries,
        ratios=change.ratios + places @ ratios,
        base_turns=turns,
        coefficients=coefficients,
        weights=np.concatenate([multipliers[:, :0], *weights], axis=1),
    )
