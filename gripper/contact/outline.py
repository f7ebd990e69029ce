"""The finger's real, thick outline: both faces, the end face, the jaw's edges, and their convex corners.

A point of the outline belongs to a section: c = r(s) + P exp(i psi(s)), with P the offset in the section's own frame:
-i w/2 on the lower face, i w/2 on the upper (Lan & Lee eq 5, with psi as Timoshenko's theory has it), a fixed point of
the end section on the end face and on the jaw (eq 4, turned the right way). Points and vectors of the plane are
complex numbers x + iy throughout the solver: a quarter turn is a factor i, a . b is Re(conj(a) b).
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from gripper.arrays import Array, Complex, Index, Mask
from gripper.beam.axis import Axis
from gripper.beam.sections import Sections

Part = Literal["lower", "upper", "tip", "jaw"]
LOWER, UPPER = 0, 1
_SAME = 1e-9


def dot(a: Complex, b: Complex) -> Array:
    """Scalar product of vectors of the plane."""
    return a.real * b.real + a.imag * b.imag


def outward(piece: Index | int, tangents: Complex) -> Complex:
    """Unit normals out of the finger: right of the tangents, on the upper face left."""
    normals: Complex = tangents / np.abs(tangents) * np.where(np.equal(piece, UPPER), 1j, -1j)
    return normals


@dataclass(frozen=True)
class Piece:
    """A face, or a straight rigid piece of the outline in the end section's frame."""

    on: Part
    length: float
    start: complex = 0j
    direction: complex = 0j
    before: float = 0.0  # arc length along the jaw's outline where the piece starts


@dataclass(frozen=True)
class Corner:
    """A convex corner of the outline, fixed in the end section's frame."""

    on: Part
    point: complex
    s: float  # what a report names as its place


class Outline:
    """Pieces and corners of a finger's outline; the jaw is rigid and moves with the end section.

    The joint between finger and jaw is no part of it: a corner or an end face that lies within the jaw cannot touch.
    """

    def __init__(self, sections: Sections) -> None:
        self.sections = sections
        half = float(sections.thickness(np.ones(1))[0]) / 2
        self._turned_jaw = False
        self.jaw = self._jaw(2 * half)
        pieces = [Piece("lower", 1.0), Piece("upper", 1.0)]
        corners = [Corner("tip", -1j * half, 1.0), Corner("tip", 1j * half, 1.0)]
        if self.jaw is not None:
            corners = [corner for corner in corners if not _inside(corner.point, self.jaw)]
        if self.jaw is None or not all(_inside(1j * y, self.jaw) for y in np.linspace(-half, half, 9)):
            pieces.append(Piece("tip", 2 * half, -1j * half, 1j))
        if self.jaw is not None:
            self._add_jaw(self.jaw, pieces, corners)
        self.pieces, self.corners = tuple(pieces), tuple(corners)
        rigid = pieces[UPPER + 1 :]
        self._starts = np.array([p.start for p in rigid] + [corner.point for corner in corners], dtype=complex)
        self._directions = np.array([p.direction for p in rigid] + [0j] * len(corners), dtype=complex)

    def _jaw(self, thickness: float) -> Complex | None:
        """The jaw's polygon, counter-clockwise, starting from its first vertex."""
        jaw = self.sections.finger.jaw
        if jaw is None:
            return None
        length = self.sections.length
        polygon = np.array([complex(x, y) for x, y in jaw.polygon(thickness * length)]) / length
        self._turned_jaw = bool(np.sum((polygon.conj() * np.roll(polygon, -1)).imag) < 0)
        return np.roll(polygon[::-1], 1) if self._turned_jaw else polygon

    def _add_jaw(self, jaw: Complex, pieces: list[Piece], corners: list[Corner]) -> None:
        edges = np.roll(jaw, -1) - jaw
        before = 0.0
        for i, (vertex, edge) in enumerate(zip(jaw.tolist(), edges.tolist(), strict=True)):
            pieces.append(Piece("jaw", abs(edge), vertex, edge / abs(edge), before))
            if (edges[i - 1].conjugate() * edge).imag > 0:
                corners.append(Corner("jaw", vertex, before))
            before += abs(edge)

    @functools.cached_property
    def room(self) -> float:
        """No point within the jaw is further from its outline than this."""
        return sum(piece.length for piece in self.pieces if piece.on == "jaw") / 4

    def corner_piece(self, corner: int) -> int:
        """The number that stands for a corner wherever a piece is asked for (a piece without length)."""
        return len(self.pieces) + corner

    def corner_at(self, piece: int, u: float) -> int | None:
        """The number of the corner at a place of a piece; None where it is not at an end, or the end is no corner."""
        length = self.pieces[piece].length
        if 1e-9 * length < u < (1 - 1e-9) * length or (piece <= UPPER and u < length / 2):
            return None
        end = self.ends(piece)[0 if u < length / 2 else 1]
        corners = [i for i, corner in enumerate(self.corners) if abs(1.0 + corner.point - end) < _SAME]
        return self.corner_piece(corners[0]) if corners else None

    def ends(self, piece: int) -> tuple[complex, ...]:
        """Where a piece or a corner ends on the straight finger (a corner: where it is)."""
        if piece >= len(self.pieces):
            return (1.0 + self.corners[piece - len(self.pieces)].point,)
        marks = np.array([0.0, self.pieces[piece].length])
        s, P, *_ = self.offsets(np.full(2, piece), marks)
        return tuple((s + P).tolist())

    def meet(self, piece: int, other: int) -> bool:
        """Whether two pieces or corners have an end in common."""
        return min(abs(a - b) for a in self.ends(piece) for b in self.ends(other)) < _SAME

    def tip_corner(self, face: int) -> int | None:
        """The number of the tip's corner at the end of a face; None where the jaw hides it."""
        side = -1 if face == LOWER else 1
        for i, corner in enumerate(self.corners):
            if corner.on == "tip" and corner.point.imag * side > 0:
                return self.corner_piece(i)
        return None

    def place(self, piece: int, u: Array) -> tuple[Part, Array]:
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

    def offsets(self, piece: Index, u: Array) -> tuple[Array, Complex, Complex, Complex]:
        """Section s, and P, dP/du, d2P/du2 (k,) of points at u (k,) along their pieces (k,)."""
        face = piece <= UPPER
        if np.logical_and.reduce(face):
            sign = (piece - 0.5) * 1j
            w, w1, w2 = self.sections.profile(np.minimum(np.maximum(u, 0.0), 1.0))
            return u, sign * w, sign * w1, sign * w2
        s = np.where(face, u, 1.0)
        P, P1, P2 = np.zeros((3, u.size), dtype=complex)
        if face.any():
            _, P[face], P1[face], P2[face] = self.offsets(piece[face], u[face])
        rigid = piece[~face] - (UPPER + 1)
        P1[~face] = self._directions[rigid]
        P[~face] = self._starts[rigid] + u[~face] * P1[~face]
        return s, P, P1, P2

    def trace(self, axis: Axis, piece: Index, u: Array, segment: Index) -> tuple[Complex, Complex, Array]:
        """Points c, c' and psi' (k,) at u (k,) along pieces (k,), from the given segments' polynomials: values alone.

        On a rigid piece psi' is 0.
        """
        s, *offsets = self.offsets(piece, u)
        return self.lifted(piece, s, offsets, axis.values(s, segment))

    def lifted(
        self, piece: Index, s: Array, offsets: Sequence[Complex], values: tuple[Complex, Array, Complex, Array]
    ) -> tuple[Complex, Complex, Array]:
        """Points c, c' and psi' (k,) at these offsets from sections s (k,) with these values of the axis."""
        P, P1, *_ = offsets
        position, psi, along, kappa = values
        if self.sections.rest is not None:
            kappa = kappa + self.sections.rest.curvature(s)[0]
        flexible = piece <= UPPER
        if not flexible.all():
            kappa, along = kappa * flexible, along * flexible
        turn = np.exp(1j * psi)
        offset = P * turn
        return position + offset, along + 1j * kappa * offset + P1 * turn, kappa

    def movable(self, axis: Axis, piece: Index, u: Array, segment: Index) -> tuple[Complex, Complex]:
        """Points c (k,) and c_z (k, n) at u (k,) along pieces (k,), from the given segments' polynomials."""
        s, P, *_ = self.offsets(piece, u)
        rows = axis.beam.rows(s, segment)
        psi = rows.strains[0] @ axis.z
        if self.sections.rest is not None:
            psi = psi + self.sections.rest.angle(s)
        offset = P * np.exp(1j * psi)
        position, moving = axis.integrated(rows.position)
        return position + offset, moving + (1j * offset)[:, None] * rows.strains[0]


def _inside(point: complex, polygon: Complex) -> bool:
    """Whether a point lies inside a polygon or on it."""
    edge, to = np.roll(polygon, -1) - polygon, point - polygon
    along = np.clip(dot(to, edge) / np.abs(edge) ** 2, 0, 1)
    if np.min(np.abs(to - along * edge)) < _SAME:
        return True
    return bool(np.sum(crossings(point, polygon)) % 2)


def crossings(point: complex, polygon: Complex) -> Mask:
    """Which edges of a polygon a ray from a point towards +x crosses: an odd number from inside."""
    a, b = polygon, np.concatenate([polygon[1:], polygon[:1]])
    across = (a.imag > point.imag) != (b.imag > point.imag)
    rise = np.where(across, b.imag - a.imag, 1.0)
    crossing: Mask = across & (a.real + (point.imag - a.imag) * (b.real - a.real) / rise > point.real)
    return crossing
