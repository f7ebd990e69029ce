"""How the contact equations of an equilibrium change: forward mode, a batch of directions at a time.

The equations are those that :func:`gripper.statics.newton.settle` solves, segments ending at the contacts:

    dV/dc = Q(c, forces),   C = 0,   R = 0,

Q the work of the contact forces by the coefficients c of the strains. A direction is a change of what they are made of:
ends of segments, places, stiffness, outline, object, ratio of friction, and (to carry a solution on) coefficients and
multipliers. Every rate is an analytic derivative.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.outline import dot
from gripper.sensitivity.geometry import Bending
from gripper.sensitivity.touching import Touching


@dataclass(frozen=True, eq=False)
class Change:
    """A batch of d directions; q queries, g Gauss points. What a direction leaves alone is 0."""

    breaks: Array  # ends of the segments, (d, segments + 1)
    queries: Array  # places of the queries along their pieces, (d, q)
    stiffness: Array  # at fixed sections, (d, fields, g)
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
    coefficients: Array | None = None  # (d, fields, segments, modes)
    weights: Array | None = None  # forces along grad g, (d, q)

    @classmethod
    def none(cls, touching: Touching, count: int) -> Change:
        """No change in any of ``count`` directions: arrays to be filled."""
        q, geometry = touching.u.size, touching.geometry
        return cls(
            breaks=np.zeros((count, geometry.segments + 1)),
            queries=np.zeros((count, q)),
            stiffness=np.zeros((count, geometry.fields, geometry.segments * geometry.count)),
            offsets=np.zeros((count, q), dtype=complex),
            offset_slopes=np.zeros((count, q), dtype=complex),
            gaps=np.zeros((count, q)),
            normals=np.zeros((count, q), dtype=complex),
            vertices=np.zeros((count, q), dtype=complex),
            ratios=np.zeros((count, q)),
            slips=np.zeros((count, touching.columns)),
            rest=np.zeros((count, geometry.segments * geometry.count)),
            rest_turns=np.zeros((count, q)),
            rest_bends=np.zeros((count, q)),
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


def flow(touching: Touching, change: Change) -> Flow:
    """Rates of points, tangents, gaps and forces."""
    t, geometry = touching, touching.geometry
    rest, rest_turns, rest_bends = t.unloaded(change.breaks, change.queries)
    bending = geometry.bent(np.diff(change.breaks, axis=1), change.coefficients, change.rest + rest)
    turns = bending.products @ t.marks.turns.T + change.rest_turns + rest_turns
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
    return Flow(bending, offsets, turns, points, tangents, normals, presses, gaps, _forces(t, change, presses))


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


def loads(t: Touching) -> Array:
    """Q: work of the contact forces by the coefficients, (fields, segments, modes)."""
    reach = t.forces.conj() @ t.marks.places
    theta, psi = _carried(t, reach)
    return _covector(t, theta, psi, t.geometry.steps * reach)


def _carried(t: Touching, reach: Complex) -> tuple[Array, Array]:
    """Moments of the forces on theta at the Gauss points (g,), and on psi at the queries (q,)."""
    return (1j * t.geometry.runs * reach).real, (t.forces.conj() * 1j * t.offset * t.turn).real


def _covector(t: Touching, theta: Array, psi: Array, drawn: Complex) -> Array:
    """Moments (..., g), (..., q) as derivatives by the coefficients (..., fields, segments, modes).

    ``drawn`` (..., g) is the work by r' in the section's frame: what gamma and eps are loaded by, with stretch.
    """
    geometry = t.geometry
    arms = (theta @ geometry.turns + psi @ t.marks.turns).reshape(*theta.shape[:-1], geometry.segments, geometry.modes)
    fields = [geometry.lengths[:, None] * arms]
    strained = {1: [], 2: [theta], 3: [(1j * drawn).real, drawn.real]}[geometry.fields]
    for moment in strained:
        fields.append(moment.reshape(*theta.shape[:-1], geometry.segments, geometry.count) @ geometry.rule.modes)
    return np.stack(fields, axis=-3)


def load_rates(t: Touching, change: Change, moved: Flow) -> Array:
    """Rates of Q, (d, fields, segments, modes)."""
    geometry, bending = t.geometry, moved.bending
    reach, reaching = t.forces.conj() @ t.marks.places, moved.forces.conj() @ t.marks.places
    theta, psi = _carried(t, reach)
    theta_rates = (1j * bending.runs * reach).real + (1j * geometry.runs * reaching).real
    offset = (moved.offsets + 1j * t.offset * moved.turns) * t.turn
    psi_rates = (moved.forces.conj() * 1j * t.offset * t.turn + t.forces.conj() * 1j * offset).real
    rates = _covector(t, theta_rates, psi_rates, bending.steps * reach + geometry.steps * reaching)
    arms = (theta @ geometry.turns + psi @ t.marks.turns).reshape(geometry.segments, -1)
    rates[:, 0] += bending.lengths[:, :, None] * arms
    return rates - _slid(t, change, moved)


def _slid(t: Touching, change: Change, moved: Flow) -> Array:
    """What a corner of the object that is off the foot of its normal takes from its load, as the face turns."""
    geometry = t.geometry
    out = np.zeros((len(moved.points), geometry.fields, geometry.segments, geometry.modes))
    for span in t.spans:
        if span.site.kind != "vertex":
            continue
        at = span.queries.start
        unit = t.tangents[at] / abs(t.tangents[at])
        along = dot(unit, moved.points[:, at] - change.vertices[:, at])
        turning = _turn_covector(t, at)
        out += (t.side(span.site) * t.weights[at] * along)[:, None, None, None] * turning
    return out


def _turn_covector(t: Touching, at: int) -> Array:
    """Derivative of the tangent's angle at a query by the coefficients, (fields, segments, modes)."""
    geometry, tangent = t.geometry, t.tangents[at]
    out = np.zeros((geometry.fields, geometry.segments, geometry.modes))
    out[0] = geometry.lengths[:, None] * t.marks.turns[at].reshape(geometry.segments, -1)
    back = (1j * tangent).conjugate() / abs(tangent) ** 2 * t.turn[at] * t.flexible[at]
    for side, leans in zip(t.sides, t.leans, strict=True):
        out[0, side.segment[at]] += 0.5 * (back * 1j * t.offset[at]).real * side.modes[at]
        for i, lean in enumerate(leans, start=1):
            out[i, side.segment[at]] += 0.5 * (back * lean[at]).real * side.modes[at]
    return out
