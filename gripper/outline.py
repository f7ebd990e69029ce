"""The finger's real, thick outline: both faces, the end face, the jaw's edges, and their convex corners.

A point of the outline belongs to a section: c = r(s) + R(psi(s)) P, with P the offset in the section's own frame:
(0, -w/2) on the lower face, (0, w/2) on the upper (Lan & Lee eq 5, with psi as Timoshenko's theory has it), a fixed
point of the end section on the end face and on the jaw (eq 4, turned the right way).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gripper.beam import Beam
from gripper.sections import Sections

Array = NDArray[np.float64]
Index = NDArray[np.intp]
LOWER, UPPER = 0, 1
_SAME = 1e-9


def rot90(v: Array) -> Array:
    """A quarter turn, counter-clockwise, of vectors (..., 2)."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


@dataclass(frozen=True)
class Piece:
    """A straight rigid piece of the outline in the end section's frame, or a face (start is None)."""

    on: str
    length: float
    start: tuple[float, float] | None = None
    direction: tuple[float, float] = (0.0, 0.0)
    before: float = 0.0  # arc length along the jaw's outline where the piece starts


@dataclass(frozen=True)
class Corner:
    """A convex corner of the outline, fixed in the end section's frame."""

    on: str
    point: tuple[float, float]
    s: float  # what a report names as its place


@dataclass(frozen=True, eq=False)
class Stations:
    """Points c of the outline and their derivatives: ' along the piece, _z in the unknowns."""

    points: Array  # (k, 2)
    tangents: Array  # c', (k, 2)
    curvatures: Array  # c'', (k, 2)
    gradients: Array  # c_z, (k, 2, n)
    tangent_gradients: Array  # c'_z, (k, 2, n)
    position: Array  # (k, g)
    offsets: Array  # R P, (k, 2)
    psi: Array  # (k, n)


@dataclass(frozen=True, eq=False)
class Axis:
    """A deflected axis: cos and sin of theta at the beam's Gauss points, as (g, 2)."""

    beam: Beam
    z: Array
    direction: Array

    @classmethod
    def of(cls, beam: Beam, z: Array) -> Axis:
        """The axis of these unknowns."""
        theta = beam.theta_map @ z
        return cls(beam, z, np.column_stack([np.cos(theta), np.sin(theta)]))

    def values(self, s: Array, segment: Index) -> tuple[Array, Array, Array, Array]:
        """Position (k, 2), psi, theta and kappa (k,) at stations s (k,) of given segments (k,)."""
        return self.beam.values(self.z, self.direction, s, segment)


class Outline:
    """Pieces and corners of a finger's outline; the jaw is rigid and moves with the end section.

    The joint between finger and jaw is no part of it: a corner or an end face that lies within the jaw cannot touch.
    """

    def __init__(self, sections: Sections) -> None:
        self.sections = sections
        half = float(sections.thickness(np.ones(1))[0]) / 2
        self.jaw = self._jaw(2 * half)
        pieces = [Piece("lower", 1.0), Piece("upper", 1.0)]
        corners = [Corner("tip", (0.0, -half), 1.0), Corner("tip", (0.0, half), 1.0)]
        if self.jaw is not None:
            corners = [corner for corner in corners if not _inside(corner.point, self.jaw)]
        if self.jaw is None or not all(_inside((0.0, y), self.jaw) for y in np.linspace(-half, half, 9)):
            pieces.append(Piece("tip", 2 * half, (0.0, -half), (0.0, 1.0)))
        if self.jaw is not None:
            self._add_jaw(pieces, corners)
        self.pieces, self.corners = tuple(pieces), tuple(corners)
        rigid = pieces[UPPER + 1 :]
        starts = [piece.start for piece in rigid] + [corner.point for corner in corners]
        directions = [piece.direction for piece in rigid] + [(0.0, 0.0)] * len(corners)
        self._starts = np.array(starts, dtype=float).reshape(-1, 2)
        self._directions = np.array(directions, dtype=float).reshape(-1, 2)

    def _jaw(self, thickness: float) -> Array | None:
        jaw = self.sections.finger.jaw
        if jaw is None:
            return None
        length = self.sections.length
        polygon = np.array(jaw.polygon(thickness * length)) / length
        x, y = polygon.T
        self._turned_jaw = bool(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0)
        return np.roll(polygon[::-1], 1, axis=0) if self._turned_jaw else polygon

    def _add_jaw(self, pieces: list[Piece], corners: list[Corner]) -> None:
        assert self.jaw is not None
        edges = np.roll(self.jaw, -1, axis=0) - self.jaw
        before = 0.0
        for i, (vertex, edge) in enumerate(zip(self.jaw, edges, strict=True)):
            length = float(np.hypot(*edge))
            direction = edge / length
            pieces.append(Piece("jaw", length, tuple(vertex), tuple(direction), before))
            if edges[i - 1][0] * edge[1] - edges[i - 1][1] * edge[0] > 0:
                corners.append(Corner("jaw", tuple(vertex), before))
            before += length

    def corner_piece(self, corner: int) -> int:
        """The number that stands for a corner wherever a piece is asked for (a piece without length)."""
        return len(self.pieces) + corner

    def place(self, piece: int, u: Array) -> tuple[str, Array]:
        """What a report calls a place: the part of the finger, and s by L (on the jaw: along its polygon as given)."""
        if piece >= len(self.pieces):
            corner = self.corners[piece - len(self.pieces)]
            on, s = corner.on, np.full(len(u), corner.s)
        else:
            on, s = self.pieces[piece].on, u + self.pieces[piece].before
        if on == "tip":
            return on, np.ones(len(u))
        if on == "jaw" and self._turned_jaw:
            return on, sum(p.length for p in self.pieces if p.on == "jaw") - s
        return on, s

    def offsets(self, piece: Index, u: Array) -> tuple[Array, Array, Array, Array]:
        """Section s (k,), and P, dP/du, d2P/du2 (k, 2) of points at u (k,) along their pieces (k,)."""
        s = np.where(piece <= UPPER, u, 1.0)
        P, P1, P2 = np.zeros((3, u.size, 2))
        face = piece <= UPPER
        if face.any():
            sign = np.where(piece[face] == LOWER, -0.5, 0.5)
            at = np.clip(u[face], 0.0, 1.0)
            P[face, 1] = sign * self.sections.thickness(at)
            P1[face, 1] = sign * self.sections.thickness_slope(at)
            P2[face, 1] = sign * self.sections.thickness_curvature(at)
        if not face.all():
            rigid = piece[~face] - (UPPER + 1)
            P1[~face] = self._directions[rigid]
            P[~face] = self._starts[rigid] + u[~face, None] * P1[~face]
        return s, P, P1, P2

    def trace(self, axis: Axis, piece: Index, u: Array, segment: Index) -> tuple[Array, Array]:
        """Points c and c' (k, 2) at u (k,) along pieces (k,), from the given segments' polynomials: values alone."""
        s, P, P1, _ = self.offsets(piece, u)
        position, psi, theta, kappa = axis.values(s, segment)
        flexible = (piece <= UPPER)[:, None]
        e0, e1 = _turned(P, psi), _turned(P1, psi)
        along = np.column_stack([np.cos(theta), np.sin(theta)]) + kappa[:, None] * rot90(e0)
        return position + e0, np.where(flexible, along, 0.0) + e1

    def stations(self, axis: Axis, piece: Index, u: Array, segment: Index) -> Stations:
        """Points and derivatives at u (k,) along pieces (k,), read from the given segments' polynomials (k,)."""
        beam, z = axis.beam, axis.z
        s, P, P1, P2 = self.offsets(piece, u)
        rows = beam.rows(s, segment)
        psi = rows.psi @ z
        e0, e1, e2 = _turned(P, psi), _turned(P1, psi), _turned(P2, psi)
        flexible = (piece <= UPPER)[:, None]
        kappa_row, theta_row = np.where(flexible, rows.kappa, 0.0), np.where(flexible, rows.psi + rows.gamma, 0.0)
        kappa = kappa_row @ z
        slopes = np.where(flexible, beam.slopes(z, rows.table, segment), 0.0)
        theta = theta_row @ z
        along = np.where(flexible, np.column_stack([np.cos(theta), np.sin(theta)]), 0.0)
        k = kappa[:, None]
        tangents = along + e1 + k * rot90(e0)
        turn = kappa + slopes[:, 1]
        curvatures = turn[:, None] * rot90(along) + e2 + 2 * k * rot90(e1) + slopes[:, :1] * rot90(e0) - k**2 * e0
        gradients = np.empty((u.size, 2, beam.size))
        gradients[:, 0] = -(rows.position * axis.direction[:, 1]) @ beam.theta_map
        gradients[:, 1] = (rows.position * axis.direction[:, 0]) @ beam.theta_map
        gradients += rot90(e0)[:, :, None] * rows.psi[:, None, :]
        tangent_gradients = (
            rot90(along)[:, :, None] * theta_row[:, None, :]
            + (rot90(e1) - k * e0)[:, :, None] * rows.psi[:, None, :]
            + rot90(e0)[:, :, None] * kappa_row[:, None, :]
        )
        points = rows.position @ axis.direction + e0
        return Stations(points, tangents, curvatures, gradients, tangent_gradients, rows.position, e0, rows.psi)


def second_derivative(axis: Axis, stations: Stations, forces: Array) -> Array:
    """sum_i f_i . d2c_i/dz2, (n, n), for vectors f (k, 2) at the stations."""
    beam = axis.beam
    at_gauss = stations.position.T @ forces
    bend = np.sum(at_gauss * axis.direction, axis=1)
    turn = np.sum(forces * stations.offsets, axis=1)
    hessian = beam.theta_map.T @ (bend[:, None] * beam.theta_map) + stations.psi.T @ (turn[:, None] * stations.psi)
    return -hessian


def _turned(P: Array, psi: Array) -> Array:
    c, s = np.cos(psi), np.sin(psi)
    return np.column_stack([c * P[:, 0] - s * P[:, 1], s * P[:, 0] + c * P[:, 1]])


def _inside(point: tuple[float, float], polygon: Array) -> bool:
    """Whether a point lies inside a polygon or on it."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    p = np.asarray(point)
    edge, to = b - a, p - a
    along = np.clip(np.sum(to * edge, axis=1) / np.sum(edge * edge, axis=1), 0, 1)
    if np.min(np.hypot(*(to - along[:, None] * edge).T)) < _SAME:
        return True
    crosses = (a[:, 1] > p[1]) != (b[:, 1] > p[1])
    x = a[:, 0] + (p[1] - a[:, 1]) * edge[:, 0] / np.where(edge[:, 1] == 0, np.inf, edge[:, 1])
    return bool(np.sum(crosses & (x > p[0])) % 2)
