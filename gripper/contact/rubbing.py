"""Friction in the contact equations: what it adds to loads and derivatives, slip, and the condition of stick.

Every term of the normal force has a twin: with the ratio rho the force on the finger is N (1 - i rho) n. The
constraints stay those of the gap, so that the system is no longer symmetric.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gripper.arrays import Array, Complex
from gripper.contact.grip import Anchor
from gripper.contact.outline import LOWER, dot

if TYPE_CHECKING:
    from gripper.contact.rows import System
    from gripper.contact.site import Site


@dataclass(frozen=True, eq=False)
class Rubbing:
    """How fast contacts slip: the velocity of the finger's matter along t relative to the object's."""

    gradients: Array  # by z's rate, (sites, n)
    rates: Array  # by the motion's parameter, z held, (sites,)
    anchors: tuple[Anchor, ...]  # where each contact is now
    ratios: tuple[float, ...]  # rho of each contact
    power: Array  # power of the friction on the finger by z's rate, (n,)
    drag: float  # the same by the parameter, z held: both make the (negative) dissipation
    pushes: Array  # loads on z of a ratio of 1 at each contact, (sites, n)


def dissipation(rubbing: Rubbing, rates: Array) -> float:
    """Energy lost per unit of the motion's parameter, from z's rate (n,)."""
    return -float(rubbing.power @ rates + rubbing.drag)


def rub(system: System, u: Array) -> None:
    """Add friction to a system into which all contacts are written."""
    system.loads = system.gradients.copy()
    system.turns = turns = np.ones(len(u), dtype=complex)
    each = [_Rubbed(system, i, u) for i in range(len(system.sites))]
    for i, (site, rubbed) in enumerate(zip(system.sites, each, strict=True)):
        turns[rubbed.span] -= 1j * rubbed.ratio
        rubbed.load()
        first = site.grip.law.leader(system.sites, i) if site.grip else i
        if site.grip is not None and site.grip.hold == "stick":
            rubbed.grip_on(each[first].ratio_column)
        rubbed.finish()
        if first == i and site.grip is not None and site.grip.unknown:
            rubbed.hold_fast()
    pushes = np.array([r.force @ r.bearing for r in each])
    moved = np.array([r.force @ r.pushed for r in each])
    system.rubbing = Rubbing(
        np.array([r.slip for r in each]),
        np.array([r.slip_rate for r in each]),
        tuple(r.anchor for r in each),
        tuple(r.ratio for r in each),
        np.array([r.ratio for r in each]) @ moved,
        -sum(r.ratio * float(r.force @ r.passing) for r in each),
        pushes,
    )


class _Rubbed:
    """Friction at one contact."""

    def __init__(self, system: System, number: int, u: Array) -> None:
        self.system, self.site = system, system.sites[number]
        self.span, self.row, self.column = system.layout[number]
        site: Site = self.site
        self.u = u[self.span]
        self.modes = self._modes()
        self.weights = self.modes[0]
        self.moves = self._moves()  # d(u of each query)/d(place), (queries, unknown places)
        middle = float(self.weights @ self.u)
        self.ratio, self.steepening = site.grip.ratios(site.piece, middle) if site.grip else (0.0, 0.0)
        self.ratio_column = self.column + site.unknown_places
        normals = system.normal[self.span]
        if site.kind == "vertex":
            normals = np.array([system.corners[self.span.start][0]])
        self.rubs = -1j * normals  # the direction of friction, as long as the gradient of the gap
        stations = system.stations
        self.gradients = stations.gradients[self.span]
        self.pushed = (self.rubs.conj()[:, None] * self.gradients).real  # how it moves, (queries, n)
        self.borne, self.borne_tangents = self.gradients, stations.tangent_gradients[self.span]
        if site.flush:
            self._at_axis()
        self.bearing = (self.rubs.conj()[:, None] * self.borne).real  # friction's unit loads, (queries, n)
        self.lengths = np.abs(normals)
        self.along = self.rubs / self.lengths
        self.passing = dot(self.rubs, system.obstacle.velocities(stations.points[self.span]))

    def _at_axis(self) -> None:
        """Flush on a flat, the pressure spreads as far as its moment takes friction's: both are as one at the axis."""
        system, stations = self.system, self.system.stations
        offsets, psi = stations.offsets[self.span], stations.psi[self.span]
        half = np.abs(offsets)
        axis = (1j if self.site.piece == LOWER else -1j) * offsets / half
        lever = (1j * offsets)[:, None] * psi
        self.borne = self.gradients - lever
        self.borne_tangents = (1j * axis)[:, None] * psi
        system.ahead[self.span] = abs(self.ratio) * half * axis
        turning = self.ratio * self._forces() * dot(self.rubs, offsets)
        system.stiffen(psi.T @ (turning[:, None] * psi))
        system.levers.append((self.span, self.ratio * lever))

    def _moves(self) -> Array:
        moves = np.zeros((len(self.u), self.site.unknown_places))
        if self.site.spreads:
            x = self.system.rule(self.site)[0]
            moves[: x.size] = np.column_stack([(1 - x) / 2, (1 + x) / 2])[:, : self.site.unknown_places]
        elif self.site.unknown_places:
            moves[0] = 1.0
        return moves

    def _forces(self) -> Array:
        """Normal force at each query by the length of its normal."""
        if self.site.kind == "vertex":
            return dot(self.system.pull[self.span], np.array([self.system.corners[self.span.start][0]]))
        return self.system.weights[self.span].copy()

    def load(self) -> None:
        """The loads of friction at its ratio, and their derivatives."""
        self.force = force = self._forces()
        system, rho, column = self.system, self.ratio, self.column
        count = self.site.multipliers
        modes = self.modes
        rows, columns = slice(self.row, self.row + count), slice(column, column + self.site.unknown_places)
        system.loads[rows] += rho * (modes @ self.bearing)
        system.force_multipliers[rows] += rho * (modes @ self.rubs)
        changed, turned = self._by_place()
        system.load_slopes[:, columns] += rho * (changed.T @ (force[:, None] * self.moves))
        system.force_places[columns] += rho * (turned @ (force[:, None] * self.moves))
        if self.steepening:
            middle = self.weights @ self.moves
            system.load_slopes[:, columns] += self.steepening * np.outer(force @ self.bearing, middle)
            system.force_places[columns] += self.steepening * complex(force @ self.rubs) * middle
        if self.site.kind == "vertex":
            self._at_corner(float(force[0]))
        system.pull[self.span] += rho * force * self.rubs

    def _modes(self) -> Array:
        """Normal force at each query of each multiplier, (multipliers, queries)."""
        modes = np.zeros((self.site.multipliers, len(self.u)))
        if self.site.spreads:
            x, mean = self.system.rule(self.site)
            modes[:, : x.size] = mean
        else:
            modes[0, 0] = 1.0
        return modes

    def _by_place(self) -> tuple[Array, Complex]:
        """Derivatives along the piece of friction's unit loads (queries, n) and direction (queries,)."""
        if self.site.kind == "vertex":
            n, _, turn, _ = self.system.corners[self.span.start]
            turned = np.array([turn * n])
        else:
            turned = -1j * self.system.bent[self.span]
        changed = (turned.conj()[:, None] * self.borne + self.rubs.conj()[:, None] * self.borne_tangents).real
        return changed, turned

    def _at_corner(self, force: float) -> None:
        """At a corner of the object the face decides the direction, and turns it."""
        n, turning, *_ = self.system.corners[self.span.start]
        push = (n.conjugate() * self.gradients[0]).real
        self.system.stiffen(self.ratio * force * np.outer(push, turning))
        self.system.force_gradient += self.ratio * force * n * turning

    def grip_on(self, column: int) -> None:
        """The loads' derivative by the ratio."""
        self.system.load_slopes[:, column] += self.force @ self.bearing
        self.system.force_places[column] += complex(self.force @ self.rubs)

    def finish(self) -> None:
        """What the normal forces weigh: the slip, and where the contact is now."""
        total = float(self.force @ self.lengths)
        self.shares = self.force * self.lengths / total if total > 0 else self.weights
        parts = self.shares / self.lengths
        self.slip, self.slip_rate = parts @ self.pushed, -float(parts @ self.passing)
        self.anchor = self._anchor()

    def _anchor(self) -> Anchor:
        frame, stations = self.system.obstacle.frame, self.system.stations
        back = complex(np.exp(-1j * frame.angle))
        points = (stations.points[self.span] - frame.origin) * back
        stretches = dot(self.along, stations.tangents[self.span])
        return Anchor(points, self.along * back, self.u, stretches, self.shares)

    def hold_fast(self) -> None:
        """No slip since the anchor: the way along the object less the way along the finger.

        Both are measured on the tangents at the anchor, the way along the finger with the mean of its stretch then
        and now: exact to second order, and at the anchor the rate of what :attr:`slip` measures.
        """
        grip, u = self.site.grip, self.u
        anchor, weights = (self.anchor if grip is None or grip.anchor is None else grip.anchor).over(self.weights)
        frame, stations, at = self.system.obstacle.frame, self.system.stations, self.ratio_column
        back = np.conj(anchor.tangents * np.exp(1j * frame.angle))
        start = anchor.points * complex(np.exp(1j * frame.angle)) + frame.origin
        points, tangents = stations.points[self.span], stations.tangents[self.span]
        way = u - anchor.u
        stretch = (anchor.stretches + (back * tangents).real) / 2
        system = self.system
        system.residuals[at] = float(weights @ ((back * (points - start)).real - way * stretch))
        inner = (weights * back)[:, None], (weights * back * way / 2)[:, None]
        system.residual_gradients[at] = (
            (inner[0] * self.gradients).real - (inner[1] * stations.tangent_gradients[self.span]).real
        ).sum(axis=0)
        each = (back * tangents).real - stretch - way / 2 * (back * stations.curvatures[self.span]).real
        columns = slice(self.column, self.column + self.site.unknown_places)
        system.residual_slopes[at, columns] = (weights * each) @ self.moves
        passing = (back * system.obstacle.velocities(points)).real
        turning = frame.spin * way / 2 * (1j * back * tangents).real
        system.anchored[at] = float(weights @ (turning - passing))
