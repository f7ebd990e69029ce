"""A deflected axis as a Legendre series on each segment: place, angle and strains, read at any station."""

from __future__ import annotations

import numpy as np

from gripper.arrays import Array, Complex, Index
from gripper.beam.legendre import evenly
from gripper.beam.strains import Beam


class Series:
    """Legendre coefficients of x, y, psi and the strains on each segment, (segments, q + 1, 3 + fields).

    Psi is what the strains turn the section by: the rest shape's part is no polynomial.

    Parameters
    ----------
    beam
        The discretised finger.
    fields
        The strain fields' coefficients, (fields, segments, p + 1).
    direction
        r' at the Gauss points, (g,).
    base_turn
        How far the base has turned, in rad.
    """

    def __init__(self, beam: Beam, fields: Array, direction: Complex, base_turn: float) -> None:
        self._beam, rule, half = beam, beam.rule, beam.halves[:, None]
        self._coefficients = out = np.zeros((beam.segments, rule.x.size + 1, 3 + beam.fields))
        path = (direction.reshape(beam.segments, -1) * half) @ rule.path.T
        out[:, :, 0], out[:, :, 1], out[:, :, 2] = path.real, path.imag, fields[0] @ rule.primitive.T * half
        out[:, : beam.modes, 3:] = fields.transpose(1, 2, 0)
        # where a segment ends is where the next one starts: every P_k is 1 at its end
        out[1:, 0, :3] += out[:-1, :, :3].sum(axis=1).cumsum(axis=0)
        out[:, 0, 2] += base_turn

    def read(self, s: Array, segment: Index) -> Array:
        """Values at stations s (k,) of given segments (k,): (k, 3 + fields)."""
        return (self._beam.table(s, segment)[:, None, :] @ self._coefficients[segment])[:, 0]

    def read_evenly(self, count: int) -> Array:
        """Values at even distances over each segment, (segments * count, 3 + fields)."""
        segments, degrees, columns = self._coefficients.shape
        read: Array = (evenly(count, degrees) @ self._coefficients).reshape(segments * count, columns)
        return read
