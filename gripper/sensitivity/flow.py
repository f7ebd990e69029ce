"""How the contact equations of an equilibrium change: forward mode, a batch of directions at a time.

The equations are those that :func:`gripper.statics.newton.settle` solves, segments ending at the contacts:

    dV/dc = Q(c, forces),   C = 0,   R = 0,

Q the work of the forces, of contacts and loads, by the coefficients c of the strains (and by the turn of the base). A
direction is a change of what they are made of: ends of segments, places, what sections answer, outline, object, ratio
of friction, loads, and (to carry a solution on) coefficients and multipliers. Every rate is an analytic derivative.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.outline import dot
from gripper.sensitivity.bearing import Moved
from gripper.sensitivity.geometry import Bending
from gripper.sensitivity.touching import Touching


@dataclass(frozen=True, eq=False)
class Change:
    """A batch of d directions; q queries, g Gauss points. What a direction leaves alone is 0."""

    breaks: Array  # ends of the segments, (d, segments + 1)
    queries: Array  # places of the queries along their pieces, (d, q)
    stresses: Array  # at fixed strains and places, (d, fields, g)
    densities: Array  # energy per length, at the same, (d, g)
    base: Array  # relative, of the stiffness of what holds the finger, (d,)
    load_forces: Complex  # of the loads on sections that stay, (d, k)
    load_couples: Array
    offsets: Complex  # of the outline, at fixed places, (d, q)
    offset_slopes: Complex  # the same by the place, (d, q)
    gaps: Array  # g at fixed points, (d, q)
    normals: Complex  # grad g at fixed points, (d, q)
    vertices: Complex  # the object's corners, (d, q)
    ratios: Array  # of friction, at fixed places, (d, q)
    slips: Array  # conditions of stick, at fixed places of the finger, (d, places)
    rest: Array  # angle of the unloaded section at fixed places: the Gauss points, (d, g)
    rest_turns: Array  # the same of the queries, (d, q)
    rest_bends: Array  # the unloaded finger's curvature at fixed places of the queries, (d, q)
    base_turns: Array  # of what holds the finger, (d,)
    coefficients: Array | None = None  # (d, fields, segments, modes)
    weights: Array | None = None  # forces along grad g, (d, q)

    @classmethod
    def none(cls, touching: Touching, count: int) -> Change:
        """No change in any of ``count`` directions: arrays to be filled."""
        q, geometry, k = touching.u.size, touching.geometry, touching.carried.count

        def zeros(*shape: int, dtype: type = float) -> Array:
            return np.zeros((count, *shape), dtype=dtype, like=touching.points)

        return cls(
            breaks=zeros(geometry.segments + 1),
            queries=zeros(q),
            stresses=zeros(geometry.fields, geometry.segments * geometry.count),
            densities=zeros(geometry.segments * geometry.count),
            base=zeros(),
            load_forces=zeros(k, dtype=complex),
            load_couples=zeros(k),
            offsets=zeros(q, dtype=complex),
            offset_slopes=zeros(q, dtype=complex),
            gaps=zeros(q),
            normals=zeros(q, dtype=complex),
            vertices=zeros(q, dtype=complex),
            ratios=zeros(q),
            slips=zeros(touching.columns),
            rest=zeros(geometry.segments * geometry.count),
            rest_turns=zeros(q),
            rest_bends=zeros(q),
            base_turns=zeros(),
        )

    def beside(self, other: Change) -> Change:
        """These directions and others after them, none of which carries a solution on."""
        names = [field.name for field in fields(self) if field.name not in ("coefficients", "weights")]
        return Change(**{name: np.concatenate([getattr(self, name), getattr(other, name)]) for name in names})


@dataclass(frozen=True, eq=False)
class Flow:
    """What a change does to the readings at the queries."""

    bending: Bending
    offsets: Complex  # P, (d, q)
    turns: Array  # psi, (d, q)
    points: Complex
    tangents: Complex
    normals: Complex  # grad g
    presses: Complex  # directions of the normal forces, as long as their unit
    gaps: Array
    forces: Complex
    loads: Moved


def flow(touching: Touching, change: Change) -> Flow:
    """Rates of points, tangents, gaps and forces."""
    t, geometry = touching, touching.geometry
    rest, rest_turns, rest_bends = t.unloaded(change.breaks, change.queries)
    base = change.base_turns[:, None]
    bending = geometry.bent(np.diff(change.breaks, axis=1), change.coefficients, change.rest + rest + base)
    turns = bending.products @ t.marks.turns.T + change.rest_turns + rest_turns + base
    offsets = change.offsets + t.offset_slope * change.queries
    slopes = change.offset_slopes + t.offset_bend * change.queries
    points = bending.runs @ t.marks.places.T + (offsets + 1j * t.offset * turns) * t.turn
    bends = t.offset * (change.rest_bends + rest_bends)
    tangents = 1j * turns * t.tangents + t.turn * (slopes + 1j * (t.kappa * offsets + bends))
    if change.coefficients is not None:
        tangents += t.turn * _strained(t, change.coefficients)
    normals = change.normals + t.curved(points)
    gaps = change.gaps + dot(t.normal, points)
    presses = _presses(t, normals, tangents)
    carried = t.carried.moved(change.breaks, bending, change.base_turns)
    carried = replace(
        carried, forces=carried.forces + change.load_forces, couples=carried.couples + change.load_couples
    )
    forces = _forces(t, change, presses)
    return Flow(bending, offsets, turns, points, tangents, normals, presses, gaps, forces, carried)


def _strained(t: Touching, coefficients: Array) -> Complex:
    """Rate of the tangent in the section's frame from the strains' own."""
    local = [np.einsum("km,dfkm->dfk", side.modes, coefficients[:, :, side.segment]) for side in t.sides]
    bent: Complex = 0.5j * t.offset * (local[0][:, 0] + local[1][:, 0])
    for leans, strains in zip(t.leans, local, strict=True):
        for i, lean in enumerate(leans, start=1):
            bent = bent + 0.5 * lean * strains[:, i]
    return t.flexible * bent


def _presses(t: Touching, normals: Complex, tangents: Complex) -> Complex:
    presses = normals
    for span in t.spans:
        if span.site.kind == "vertex":
            at = span.queries.start
            presses = presses.copy() if presses is normals else presses
            presses[:, at] = 1j * t.press[at] * _turning(t, at, tangents)
    return presses


def _forces(t: Touching, change: Change, press: Complex) -> Complex:
    ratios = change.ratios.copy()
    for span in t.spans:
        middle, slope = t.middle(span)
        if slope:
            ratios[:, span.queries] += slope * (change.queries[:, span.queries] @ middle)[:, None]
    forces: Complex = t.weights * (t.incline * press - 1j * ratios * t.press)
    if change.weights is not None:
        forces += change.weights * t.incline * t.press
    return forces


def _turning(t: Touching, at: int, tangents: Complex) -> Array:
    """Rate at which the tangent turns at a query."""
    tangent = t.tangents[at]
    turned: Array = (tangent.conjugate() * tangents[:, at]).imag / abs(tangent) ** 2
    return turned


def load_rates(t: Touching, change: Change, moved: Flow) -> tuple[Array, Array]:
    """Rates of Q: by the coefficients, (d, fields, segments, modes), and by the base's turn, (d,)."""
    geometry, bending, actors = t.geometry, moved.bending, t.actors
    forces = np.concatenate([t.forces, t.carried.forces])
    forcing = np.concatenate([moved.forces, moved.loads.forces], axis=1)
    reach, reaching = forces.conj() @ actors.places, forcing.conj() @ actors.places
    theta = (1j * geometry.runs * reach).real
    psi = np.concatenate([(t.forces.conj() * 1j * t.offset * t.turn).real, t.carried.couples])
    theta_rates = (1j * bending.runs * reach).real + (1j * geometry.runs * reaching).real
    offset = (moved.offsets + 1j * t.offset * moved.turns) * t.turn
    turned = (moved.forces.conj() * 1j * t.offset * t.turn + t.forces.conj() * 1j * offset).real
    psi_rates = np.concatenate([turned, moved.loads.couples], axis=1)
    rates = _covector(t, theta_rates, psi_rates, bending.steps * reach + geometry.steps * reaching)
    arms = (theta @ geometry.turns + psi @ actors.turns).reshape(geometry.segments, -1)
    rates[:, 0] += bending.lengths[:, :, None] * arms
    slid, turning = _slid(t, change, moved)
    return rates - slid, theta_rates.sum(axis=1) + psi_rates.sum(axis=1) - turning


def _covector(t: Touching, theta: Array, psi: Array, drawn: Complex) -> Array:
    """Moments (d, g), (d, actors) as derivatives by the coefficients (d, fields, segments, modes).

    ``drawn`` (d, g) is the work by r' in the section's frame: what gamma and eps are loaded by, with stretch.
    """
    geometry = t.geometry
    arms = (theta @ geometry.turns + psi @ t.actors.turns).reshape(len(theta), geometry.segments, geometry.modes)
    fields = [geometry.lengths[:, None] * arms]
    strained = {1: [], 2: [theta], 3: [(1j * drawn).real, drawn.real]}[geometry.fields]
    for moment in strained:
        fields.append(moment.reshape(len(theta), geometry.segments, geometry.count) @ geometry.rule.modes)
    return np.stack(fields, axis=1)


def _slid(t: Touching, change: Change, moved: Flow) -> tuple[Array, Array]:
    """What a corner of the object that is off the foot of its normal takes from its load, as the face turns."""
    geometry = t.geometry
    shape = len(moved.points), geometry.fields, geometry.segments, geometry.modes
    out, turning = (np.zeros(size, like=t.points) for size in (shape, shape[:1]))
    for span in t.spans:
        if span.site.kind != "vertex":
            continue
        at = span.queries.start
        unit = t.tangents[at] / abs(t.tangents[at])
        along = dot(unit, moved.points[:, at] - change.vertices[:, at])
        slid = t.side(span.site) * t.weights[at] * along
        out += slid[:, None, None, None] * _turn_covector(t, at)
        turning += slid
    return out, turning


def _turn_covector(t: Touching, at: int) -> Array:
    """Derivative of the tangent's angle at a query by the coefficients, (fields, segments, modes)."""
    geometry, tangent = t.geometry, t.tangents[at]
    out = np.zeros((geometry.fields, geometry.segments, geometry.modes), like=t.points)
    out[0] = geometry.lengths[:, None] * t.marks.turns[at].reshape(geometry.segments, -1)
    back = (1j * tangent).conjugate() / abs(tangent) ** 2 * t.turn[at] * t.flexible[at]
    for side, leans in zip(t.sides, t.leans, strict=True):
        out[0, side.segment[at]] += 0.5 * (back * 1j * t.offset[at]).real * side.modes[at]
        for i, lean in enumerate(leans, start=1):
            out[i, side.segment[at]] += 0.5 * (back * lean[at]).real * side.modes[at]
    return out
