"""What a finger's numbers change: stiffness, thickness, rigid outline, kinks and the two scales."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy

from gripper.arrays import Array, Complex, Index
from gripper.contact.outline import UPPER, Outline
from gripper.fingers import S
from gripper.kinks import beside_kinks
from gripper.objects.compiled import compiled
from gripper.sensitivity.jet import lifted
from gripper.sensitivity.opened import derivatives, profile


class FingerRates:
    """Derivatives of a finger's dimensionless sections and outline by some of its numbers.

    Everything is at a fixed sigma = s / L; the leading axis counts the numbers (p).

    Parameters
    ----------
    outline
        Of the finger.
    values
        The finger's and its material's numbers by their keys, as :class:`gripper.sensitivity.opened.Opened` names them.
    """

    def __init__(self, outline: Outline, values: Mapping[str, float]) -> None:
        self.outline, self.sections = outline, outline.sections
        finger, self.length = self.sections.finger, self.sections.length
        formulas, symbols = profile(finger, tuple(values.items()))
        self.keys = tuple(symbols)
        self.values = [values[key] for key in self.keys]
        by = tuple(symbols[key] for key in self.keys)
        stiffness = (formulas.bending, formulas.shear, formulas.stretch)
        expressions = (formulas.thickness, sympy.diff(formulas.thickness, S), *stiffness)
        self._expressions, self._symbols = expressions, by
        self._along = derivatives(expressions, (S, *by), (S, *by))
        self._kinks = derivatives(formulas.kinks, by, by) if formulas.kinks else None
        flat = tuple(value for point in formulas.jaw for value in point)
        self._polygon = derivatives(flat, by, by) if flat else None
        self.count = len(by)
        self.log_length = np.array([1 / self.length if key == "length" else 0.0 for key in self.keys])
        clamp = self._table(np.zeros(1))
        self.log_stiffness = clamp[2:, 2, 0] / clamp[0, 2, 0]

    def _table(self, sigma: Array) -> Array:
        """w, w', EI, GA, EA in SI, then their rates by s and by each number: (2 + p, 5, k)."""
        return lifted(functools.partial(self._filled, self._along), self._ahead, sigma)

    def _filled(self, function: Any, sigma: Array) -> Array:
        found = function(sigma * self.length, *self.values)
        table = np.empty((len(found), sigma.size))
        for row, values in enumerate(found):
            table[row] = values  # a constant fills its row
        return table.reshape(-1, 5, sigma.size)

    def _ahead(self, sigma: Array) -> Array:
        """The table's slopes by sigma."""
        return self._filled(self._steeper, sigma) * self.length

    @functools.cached_property
    def _steeper(self) -> Any:
        by = (S, *self._symbols)
        return derivatives(tuple(sympy.diff(expression, S) for expression in self._expressions), by, by)

    def bends(self, piece: Index, u: Array) -> Complex:
        """d3P/du3 of points of the outline (k,) at u (k,) along their pieces."""
        values: Array = self._third(u * self.length, *self.values)[0] * self.length**2
        return np.where(piece <= UPPER, (piece - 0.5) * 1j * values, 0.0)

    @functools.cached_property
    def _third(self) -> Any:
        return compiled((S, *self._symbols), (beside_kinks(sympy.diff(self._expressions[0], S, 3)),))

    def thickness(self, sigma: Array) -> tuple[Array, Array]:
        """Rates of w / L and of dw/ds, (p, k)."""
        table, stretch = self._table(sigma), self.log_length[:, None]
        w, slope, moved = table[0, 0] / self.length, table[1], sigma * self.length
        thick = table[2:, 0] / self.length + stretch * (slope[0] * sigma - w)
        return thick, table[2:, 1] + stretch * slope[1] * moved

    def stiffness(self, sigma: Array, fields: int) -> tuple[Array, Array, Array]:
        """EI, GA L^2 and EA L^2 over EI(0): values and slopes by sigma (fields, k), rates (p, fields, k)."""
        table = self._table(sigma)[:, 2 : 2 + fields]
        unit = np.array([1.0, self.length**2, self.length**2])[:fields, None] / self.sections.bending_stiffness
        powers = np.array([0.0, 2.0, 2.0])[:fields, None]
        values, slopes = table[0] * unit, table[1] * unit * self.length
        stretch, stiffer = self.log_length[:, None, None], self.log_stiffness[:, None, None]
        return values, slopes, table[2:] * unit + stretch * slopes * sigma + values * (powers * stretch - stiffer)

    def rest(self, sigma: Array) -> tuple[Array, Array]:
        """Rates of the unloaded section's angle, and of the curvature at rest times L, (p, k)."""
        own, stretch = self.sections.rest, self.log_length[:, None]
        curved = np.array([self.length if key == "rest_curvature" else 0.0 for key in self.keys])[:, None]
        turns, bends = curved * sigma, curved + 0 * sigma
        if own is not None:
            curvature, slope = own.curvature(sigma)
            turns, bends = turns + stretch * sigma * curvature, bends + stretch * (curvature + sigma * slope)
        return turns, bends

    def kinks(self) -> tuple[Array, Array]:
        """Kinks of profile and rest shape by L (j,), and their rates (p, j)."""
        own, table = self.sections.rest, np.zeros((1 + self.count, 0))
        if self._kinks is not None:
            table = np.array(self._kinks(*self.values), dtype=float).reshape(1 + self.count, -1) / self.length
        if own is not None:
            bent = np.zeros((1 + self.count, len(own.kinks)))
            bent[0] = own.kinks
            table = np.concatenate([table, bent], axis=1)
        return table[0], table[1:] - self.log_length[:, None] * table[0]

    def lengths(self) -> Array:
        """Rates of the rigid pieces' lengths, (p, pieces)."""
        vertices = self._vertices()
        edges, at, out = np.roll(vertices, -1, axis=1) - vertices, 0, []
        for piece in self.outline.pieces[UPPER + 1 :]:
            if piece.on == "tip":
                out.append(self.thickness(np.ones(1))[0][:, 0])
                continue
            out.append((piece.direction.conjugate() * edges[:, at]).real)
            at += 1
        return np.array(out).reshape(len(out), self.count).T

    def rigid(self) -> tuple[Complex, Complex]:
        """Rates of start and direction of the outline's rigid pieces and corners, as it numbers them: (p, pieces)."""
        outline, half = self.outline, self.thickness(np.ones(1))[0][:, 0] / 2
        vertices = self._vertices()
        edges = np.roll(vertices, -1, axis=1) - vertices
        starts, directions = [], []
        at = 0
        for piece in outline.pieces[UPPER + 1 :]:
            if piece.on == "tip":
                starts.append(-1j * half)
                directions.append(0j * half)
                continue
            starts.append(vertices[:, at])
            turning = (piece.direction.conjugate() * edges[:, at]).imag / piece.length
            directions.append(1j * piece.direction * turning)
            at += 1
        for corner in outline.corners:
            starts.append(self._corner(corner.on, corner.point, half, vertices))
            directions.append(0j * half)
        shape = (len(starts), self.count)
        return np.array(starts, dtype=complex).reshape(shape).T, np.array(directions, dtype=complex).reshape(shape).T

    def _corner(self, on: str, point: complex, half: Array, vertices: Complex) -> Complex:
        if on == "tip":
            return np.sign(point.imag) * 1j * half
        jaw: Any = self.outline.jaw
        found: Complex = vertices[:, int(np.argmin(np.abs(jaw - point)))]
        return found

    def _vertices(self) -> Complex:
        """Rates of the jaw's polygon, in the order of the outline's, (p, vertices)."""
        if self._polygon is None:
            return np.zeros((self.count, 0), dtype=complex)
        table = np.array(self._polygon(*self.values), dtype=float).reshape(1 + self.count, -1, 2) / self.length
        points = table[..., 0] + 1j * table[..., 1]
        polygon, rates = points[0], points[1:] - self.log_length[:, None] * points[0]
        jaw: Any = self.outline.jaw
        order = [int(np.argmin(np.abs(polygon - vertex))) for vertex in jaw]
        return rates[:, order]
